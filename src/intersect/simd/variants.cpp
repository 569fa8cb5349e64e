#include "intersect/simd/variants.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "intersect/catalogue.hpp"
#include "intersect/simd/packed_target.hpp"
#include "intersect/simd/variant_raw.hpp"

namespace lostbits::intersect::simd {

using table::HitBatch;
using table::Intersector;
using table::RayBatch;

namespace {

constexpr std::size_t register_bytes = 32;

using Fill = void (*)(RawRow*);

template <Fill fill>
const std::array<RawRow, form_count>& raw_rows() {
    static const auto rows = [] {
        std::array<RawRow, form_count> filled{};
        fill(filled.data());
        return filled;
    }();
    return rows;
}

template <class F>
using RawKernel = void (*)(const RawBatch<F>&);

/// Whole packs, and then the last pack's worth of rays once more: where the two overlap the same is written twice.
template <class F>
void run_packs(RawKernel<F> kernel, const RayBatch<F>& rays, const RawTarget<F>& target, const HitBatch<F>& hits) {
    constexpr std::size_t lanes = register_bytes / sizeof(F);
    const auto from = [&](std::size_t i, std::size_t size) { return raw_batch(rays, target, hits, i, size); };
    kernel(from(0, rays.size() / lanes * lanes));
    if (rays.size() % lanes != 0) kernel(from(rays.size() - lanes, lanes));
}

/// Fewer rays than a pack holds, filled up with the last of them.
template <class F>
void run_few(RawKernel<F> kernel, const RayBatch<F>& rays, const RawTarget<F>& target, const HitBatch<F>& hits) {
    constexpr std::size_t lanes = register_bytes / sizeof(F);
    const auto filled = [](std::span<const F> column) {
        std::vector<F> out(column.begin(), column.end());
        if (!out.empty()) out.resize(lanes, out.back());
        return out;
    };
    const auto ox = filled(rays.ox), oy = filled(rays.oy), oz = filled(rays.oz), dx = filled(rays.dx),
               dy = filled(rays.dy), dz = filled(rays.dz), tmax = filled(rays.tmax);
    std::array<F, lanes> t{}, near{}, far{};
    std::array<std::uint8_t, lanes> hit{};
    run_packs<F>(kernel, {ox, oy, oz, dx, dy, dz, tmax}, target, {t, near, far, hit});
    std::copy_n(t.begin(), rays.size(), hits.t.begin());
    std::copy_n(near.begin(), rays.size(), hits.near.begin());
    std::copy_n(far.begin(), rays.size(), hits.far.begin());
    std::copy_n(hit.begin(), rays.size(), hits.hit.begin());
}

template <class F>
void run(RawKernel<F> kernel, const RayBatch<F>& rays, const Target<F>& target, const HitBatch<F>& hits) {
    if (rays.size() == 0) return;
    const FlatTarget<F> flat(target);
    if (rays.size() < register_bytes / sizeof(F)) run_few(kernel, rays, flat.raw(), hits);
    else run_packs(kernel, rays, flat.raw(), hits);
}

template <Fill fill, std::size_t form>
void run32(const RayBatch<float>& rays, const Target<float>& target, const HitBatch<float>& hits) {
    run(raw_rows<fill>()[form].f32, rays, target, hits);
}

template <Fill fill, std::size_t form>
void run64(const RayBatch<double>& rays, const Target<double>& target, const HitBatch<double>& hits) {
    run(raw_rows<fill>()[form].f64, rays, target, hits);
}

/// A table of its own, whose names and infos live as long as the program.
template <Fill fill>
std::span<const Intersector> rows_of(std::string_view variant) {
    static std::array<std::string, form_count> names;
    static std::array<Info, form_count> infos;
    static const auto rows = [variant]<std::size_t... form>(std::index_sequence<form...>) {
        const auto table = table::intersectors();
        for (std::size_t i = 0; i < form_count; ++i) {
            names[i] = std::string(table[i].info->name) + "+" + std::string(variant);
            infos[i] = *table[i].info;
            infos[i].name = names[i];
        }
        const auto& raw = raw_rows<fill>();
        return std::array<Intersector, form_count>{Intersector{&infos[form], table[form].shape, run32<fill, form>,
                                                               raw[form].f64 ? run64<fill, form> : nullptr, nullptr,
                                                               nullptr, nullptr}...};
    }
    (std::make_index_sequence<form_count>{});
    return rows;
}

}  // namespace

std::span<const Variant> variants() {
#if defined(LOSTBITS_PACKED_X86)
    static const auto all = [] {
        std::vector<Variant> found;
        const auto isas = available_isas();
        if (std::ranges::find(isas, Isa::w256) == isas.end()) return found;
        found.push_back({"contract", Isa::w256, rows_of<fill_variant_contract>("contract")});
        found.push_back({"fastmath", Isa::w256, rows_of<fill_variant_fastmath>("fastmath")});
        return found;
    }();
    return all;
#else
    return {};
#endif
}

}  // namespace lostbits::intersect::simd
