#include "intersect/simd/packed.hpp"

#include <algorithm>
#include <atomic>
#include <deque>
#include <string>
#include <utility>

#include "intersect/catalogue.hpp"
#include "intersect/simd/packed_target.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::simd {

using table::HitBatch;
using table::RayBatch;

namespace {

constexpr std::size_t forms = form_count;

constexpr std::size_t bytes_of(Isa isa) { return isa == Isa::w512 ? 64 : isa == Isa::w256 ? 32 : 16; }

template <Isa isa>
const std::array<RawRow, forms>& raw_rows() {
    static const auto rows = [] {
        std::array<RawRow, forms> filled{};
        if constexpr (isa == Isa::w128) fill_packed_w128(filled.data());
#if defined(LOSTBITS_PACKED_X86)
        if constexpr (isa == Isa::w256) fill_packed_w256(filled.data());
        if constexpr (isa == Isa::w512) fill_packed_w512(filled.data());
#endif
        return filled;
    }();
    return rows;
}

template <Isa isa, std::size_t form>
void run32(const RayBatch<float>& rays, const Target<float>& target, const HitBatch<float>& hits) {
    run_packed(raw_rows<isa>()[form].f32, bytes_of(isa) / sizeof(float), rays, target, hits);
}

template <Isa isa, std::size_t form>
void run64(const RayBatch<double>& rays, const Target<double>& target, const HitBatch<double>& hits) {
    run_packed(raw_rows<isa>()[form].f64, bytes_of(isa) / sizeof(double), rays, target, hits);
}

template <Isa isa>
std::span<const PackedRow> rows_of() {
    static const auto rows = []<std::size_t... form>(std::index_sequence<form...>) {
        const auto scalar = table::catalogue();
        const auto& raw = raw_rows<isa>();
        return std::array<PackedRow, forms>{
            PackedRow{scalar[form].info, run32<isa, form>, raw[form].f64 ? run64<isa, form> : nullptr}...};
    }
    (std::make_index_sequence<forms>{});
    return rows;
}

std::span<const PackedRow> scalar_rows() {
    static const auto rows = [] {
        std::array<PackedRow, forms> filled{};
        std::ranges::transform(table::catalogue(), filled.begin(), [](const table::Intersector& i) {
            return PackedRow{i.info, i.native32, i.native64};
        });
        return filled;
    }();
    return rows;
}

bool runs(Isa isa) {
    switch (isa) {
        case Isa::scalar:
        case Isa::w128: return true;
#if defined(LOSTBITS_PACKED_X86)
        case Isa::w256: return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
        case Isa::w512:
            return runs(Isa::w256) && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("avx512f") &&
                   __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#endif
        default: return false;
    }
}

}  // namespace

std::optional<Isa> isa_named(std::string_view name) {
    const auto found = std::ranges::find(isa_names, name);
    if (found == isa_names.end()) return std::nullopt;
    return static_cast<Isa>(found - isa_names.begin());
}

std::vector<Isa> available_isas() {
    std::vector<Isa> all{Isa::scalar, Isa::w128, Isa::w256, Isa::w512};
    std::erase_if(all, [](Isa isa) { return !runs(isa); });
    return all;
}

Isa best_isa() { return available_isas().back(); }

namespace {

std::atomic<Isa>& chosen_isa() {
    static std::atomic<Isa> isa = best_isa();
    return isa;
}

}  // namespace

void set_isa(Isa isa) {
    if (!runs(isa)) {
        std::string can;
        for (const Isa other : available_isas()) can += (can.empty() ? "" : ", ") + std::string(name_of(other));
        throw EnvironmentError(
            "--isa " + std::string(name_of(isa)) +
            ": this processor has no registers of that width, or this build no code for them; try one of " + can +
            ", which give the same bits");
    }
    chosen_isa() = isa;
}

Isa current_isa() { return chosen_isa(); }

std::span<const PackedRow> packed_rows(Isa isa) {
    if (!runs(isa)) return {};
    switch (isa) {
        case Isa::scalar: return scalar_rows();
        case Isa::w128: return rows_of<Isa::w128>();
        case Isa::w256: return rows_of<Isa::w256>();
        case Isa::w512: return rows_of<Isa::w512>();
    }
    return {};
}

namespace {

/// A kernel over packs and how many numbers its registers hold: what a bound kernel needs of its own.
template <class S>
struct OwnPack {
    RawKernel<S> kernel;
    std::size_t lanes;
};

template <class S>
void run_own(void* own, const RayBatch<S>& rays, const Target<S>& target, const HitBatch<S>& hits) {
    const auto& pack = *static_cast<const OwnPack<S>*>(own);
    run_packed(pack.kernel, pack.lanes, rays, target, hits);
}

struct OwnWidths {
    const Info* info;
    std::array<OwnPack<float>, 3> f32;
    std::array<OwnPack<double>, 3> f64;
};

std::deque<OwnWidths>& own_packs() {
    static std::deque<OwnWidths> rows;
    return rows;
}

PackedRow native_kernels(const table::Intersector& form) { return {form.info, form.native32, form.native64}; }

/// The kernels of a row at a width; nothing where it is in no packs.
std::optional<PackedRow> found_in_packs(const table::Intersector& form, Isa isa) {
    const auto scalar = scalar_rows();
    const auto same = std::ranges::find_if(scalar, [&](const PackedRow& row) {
        return row.info == form.info && row.f32 == form.native32 && row.f64 == form.native64;
    });
    if (same != scalar.end()) return packed_rows(isa)[static_cast<std::size_t>(same - scalar.begin())];
    const auto own = std::ranges::find(own_packs(), form.info, &OwnWidths::info);
    if (own == own_packs().end() || isa == Isa::scalar) return std::nullopt;
    const auto width = static_cast<std::size_t>(isa) - 1;
    PackedRow row = native_kernels(form);
    if (own->f32[width].kernel == nullptr) return std::nullopt;
    row.f32 = {run_own<float>, &own->f32[width]};
    if (own->f64[width].kernel != nullptr) row.f64 = {run_own<double>, &own->f64[width]};
    return row;
}

}  // namespace

PackedRow packed_kernels(const table::Intersector& form, Isa isa) {
    return found_in_packs(form, isa).value_or(native_kernels(form));
}

PackedRow packed_kernels(const table::Intersector& form) { return packed_kernels(form, current_isa()); }

bool is_packed(const table::Intersector& form, Isa isa) {
    return isa != Isa::scalar && found_in_packs(form, isa).has_value();
}

void enroll_packs(const std::vector<OwnPacks>& rows) {
    for (const OwnPacks& row : rows) {
        OwnWidths& kept = own_packs().emplace_back(OwnWidths{row.info, {}, {}});
        for (std::size_t w = 0; w < row.widths.size(); ++w) {
            const std::size_t bytes = bytes_of(static_cast<Isa>(w + 1));
            kept.f32[w] = {row.widths[w].f32, bytes / sizeof(float)};
            kept.f64[w] = {row.widths[w].f64, bytes / sizeof(double)};
        }
    }
}

}  // namespace lostbits::intersect::simd
