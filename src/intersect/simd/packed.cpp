#include "intersect/simd/packed.hpp"

#include <algorithm>
#include <atomic>
#include <concepts>
#include <deque>
#include <string>

#include "intersect/simd/of_width.hpp"
#include "intersect/simd/packed_target.hpp"
#include "intersect/table/fill_forms.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::simd {

namespace {

/// The rows for one register width. The functions were compiled for that width, so call them only on a machine that has
/// the width.
struct RowsOfWidth {
    std::vector<RegisterKernels> packs;
    std::vector<PackedFormKernels> rows;

    explicit RowsOfWidth(Isa isa) {
        using Fill = RawFormKernels*(RawFormKernels*);
        constexpr FunctionOfWidth<Fill> fill_first = LOSTBITS_OF_EACH_WIDTH(fill_packed, <FirstForms>);
        constexpr FunctionOfWidth<Fill> fill_second = LOSTBITS_OF_EACH_WIDTH(fill_packed, <SecondForms>);
        const auto forms = table::catalogue();
        std::vector<RawFormKernels> raw(forms.size());
        fill_second.at(isa)(fill_first.at(isa)(raw.data()));
        for (const RawFormKernels& row : raw) packs.emplace_back(row, bytes_of(isa));
        for (std::size_t i = 0; i < forms.size(); ++i)
            rows.emplace_back(forms[i].info, packs[i].f32.table_kernel(), packs[i].f64.table_kernel());
    }
    RowsOfWidth(const RowsOfWidth&) = delete;
    RowsOfWidth& operator=(const RowsOfWidth&) = delete;
};

std::span<const PackedFormKernels> scalar_rows() {
    static const auto rows = [] {
        std::vector<PackedFormKernels> filled;
        for (const table::Intersector& form : table::catalogue())
            filled.emplace_back(form.info, form.native32, form.native64);
        return filled;
    }();
    return rows;
}

bool is_available(Isa isa) {
    switch (isa) {
        case Isa::scalar: return true;
#ifdef LOSTBITS_HAS_W128
        case Isa::w128: return true;
#endif
#ifdef LOSTBITS_HAS_W256
        case Isa::w256: return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
#ifdef LOSTBITS_HAS_W512
        case Isa::w512:
            return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2") &&
                   __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512vl");
#endif
        default: return false;
    }
}

}  // namespace

std::optional<Isa> find_isa(std::string_view name) {
    const auto found = std::ranges::find(isa_names, name);
    if (found == isa_names.end()) return std::nullopt;
    return static_cast<Isa>(found - isa_names.begin());
}

std::vector<Isa> available_isas() {
    std::vector<Isa> isas{Isa::scalar, Isa::w128, Isa::w256, Isa::w512};
    std::erase_if(isas, [](Isa isa) { return !is_available(isa); });
    return isas;
}

Isa best_isa() { return available_isas().back(); }

namespace {

std::atomic<Isa>& chosen_isa() {
    static std::atomic<Isa> isa = best_isa();
    return isa;
}

}  // namespace

void set_isa(Isa isa) {
    if (!is_available(isa)) {
        std::string available_names;
        for (const Isa other : available_isas())
            available_names += (available_names.empty() ? "" : ", ") + std::string(name_of(other));
        throw EnvironmentError(
            "--isa " + std::string(name_of(isa)) +
            ": this processor has no registers of that width, or this build has no code for them; try one of " +
            available_names + ", which all give the same bits");
    }
    chosen_isa() = isa;
}

Isa current_isa() { return chosen_isa(); }

Isa register_isa(Isa isa) {
    if (isa != Isa::scalar) return isa;
    static const std::vector<Isa> available = available_isas();
    if (available.size() < 2)
        throw EnvironmentError(
            "this build has code only for registers that this processor lacks; configure the build with "
            "-DLOSTBITS_PACK_WIDTHS=all");
    return available[1];
}

std::span<const PackedFormKernels> all_packed_kernels(Isa isa) {
    if (!is_available(isa)) return {};
    if (isa == Isa::scalar) return scalar_rows();
    return with_width(isa, []<Isa width>() -> std::span<const PackedFormKernels> {
        static const RowsOfWidth of_width(width);
        return of_width.rows;
    });
}

namespace {

struct ExternalKernels {
    const Info* info;
    std::array<RegisterKernels, 3> widths = {};
};

std::deque<ExternalKernels>& external_packs() {
    static std::deque<ExternalKernels> rows;
    return rows;
}

PackedFormKernels native_kernels(const table::Intersector& form) { return {form.info, form.native32, form.native64}; }

/// Returns the kernels of a row at a width; empty if the row is not compiled for packs.
std::optional<PackedFormKernels> find_packed(const table::Intersector& form, Isa isa) {
    const auto scalar = scalar_rows();
    const auto entry = std::ranges::find_if(scalar, [&](const PackedFormKernels& row) {
        return row.info == form.info && row.f32 == form.native32 && row.f64 == form.native64;
    });
    if (entry != scalar.end()) return all_packed_kernels(isa)[entry - scalar.begin()];
    const auto external = std::ranges::find(external_packs(), form.info, &ExternalKernels::info);
    if (external == external_packs().end() || isa == Isa::scalar) return std::nullopt;
    RegisterKernels& kernels = external->widths[static_cast<std::size_t>(isa) - 1];
    PackedFormKernels row = native_kernels(form);
    if (!kernels.f32.kernel) return std::nullopt;
    row.f32 = kernels.f32.table_kernel();
    if (kernels.f64.kernel) row.f64 = kernels.f64.table_kernel();
    return row;
}

/// Runs a batch on a set, by the packed kernel of the set's form for the shape of the target. `context` is the set.
template <class S, Isa isa>
void run_of_set(void* context, const table::RayBatch<S>& rays, const Target<S>& target,
                const table::HitBatch<S>& hits) {
    const auto& set = *static_cast<const table::Intersector*>(context);
    const PackedFormKernels row = packed_kernels(set.form_for(target.primitives.front().shape), isa);
    if constexpr (std::same_as<S, float>) row.f32(rays, target, hits);
    else row.f64(rays, target, hits);
}

template <Isa isa>
PackedFormKernels set_kernels_at(const table::Intersector& set) {
    auto* const context = const_cast<table::Intersector*>(&set);
    PackedFormKernels row = native_kernels(set);
    if (row.f32) row.f32 = {run_of_set<float, isa>, context};
    if (row.f64) row.f64 = {run_of_set<double, isa>, context};
    return row;
}

PackedFormKernels kernels_of_set(const table::Intersector& set, Isa isa) {
    if (isa == Isa::scalar) return native_kernels(set);
    return with_width(isa, [&set]<Isa width>() { return set_kernels_at<width>(set); });
}

}  // namespace

PackedFormKernels packed_kernels(const table::Intersector& form, Isa isa) {
    if (form.is_set()) return kernels_of_set(form, isa);
    return find_packed(form, isa).value_or(native_kernels(form));
}

PackedFormKernels packed_kernels(const table::Intersector& form) { return packed_kernels(form, current_isa()); }

bool is_packed(const table::Intersector& form, Isa isa) {
    if (form.is_set())
        return std::ranges::all_of(form.parts, [isa](const table::Intersector* part) { return is_packed(*part, isa); });
    return isa != Isa::scalar && find_packed(form, isa).has_value();
}

void register_packs(const std::vector<ExternalPacks>& rows) {
    for (const ExternalPacks& row : rows) {
        ExternalKernels& kernels = external_packs().emplace_back(ExternalKernels{row.info, {}});
        for (std::size_t w = 0; w < row.widths.size(); ++w)
            kernels.widths[w] = {row.widths[w], bytes_of(static_cast<Isa>(w + 1))};
    }
}

}  // namespace lostbits::intersect::simd
