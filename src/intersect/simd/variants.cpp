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

template <Fill fill, std::size_t form>
void run32(const RayBatch<float>& rays, const Target<float>& target, const HitBatch<float>& hits) {
    run_packed(raw_rows<fill>()[form].f32, register_bytes / sizeof(float), rays, target, hits);
}

template <Fill fill, std::size_t form>
void run64(const RayBatch<double>& rays, const Target<double>& target, const HitBatch<double>& hits) {
    run_packed(raw_rows<fill>()[form].f64, register_bytes / sizeof(double), rays, target, hits);
}

/// A table of its own, whose names and infos live as long as the program.
template <Fill fill>
std::span<const Intersector> rows_of(std::string_view variant) {
    static std::array<std::string, form_count> names;
    static std::array<Info, form_count> infos;
    static const auto rows = [variant]<std::size_t... form>(std::index_sequence<form...>) {
        const auto table = table::catalogue();
        for (std::size_t i = 0; i < form_count; ++i) {
            names[i] = std::string(table[i].info->name) + "+" + std::string(variant);
            infos[i] = *table[i].info;
            infos[i].name = names[i];
        }
        const auto& raw = raw_rows<fill>();
        return std::array<Intersector, form_count>{
            Intersector{.info = &infos[form],
                        .shape = table[form].shape,
                        .native32 = run32<fill, form>,
                        .native64 = raw[form].f64 ? run64<fill, form> : nullptr}...};
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
