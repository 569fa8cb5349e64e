#include "intersect/simd/variants.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "intersect/catalogue.hpp"
#include "intersect/simd/packed_target.hpp"
#include "intersect/simd/variant_raw.hpp"

namespace lostbits::intersect::simd {

using table::Intersector;

namespace {

constexpr std::size_t register_bytes = 32;

/// A table of its own, whose names, infos and kernels live as long as the program.
struct Table {
    std::array<std::string, form_count> names;
    std::array<Info, form_count> infos;
    std::array<OwnPacksOfRow, form_count> packs;
    std::vector<Intersector> rows;

    Table(std::string_view variant, void (*fill)(RawRow*)) {
        std::array<RawRow, form_count> raw{};
        fill(raw.data());
        for (std::size_t i = 0; i < form_count; ++i) {
            const Intersector& form = table::catalogue()[i];
            names[i] = std::string(form.info->name) + "+" + std::string(variant);
            infos[i] = *form.info;
            infos[i].name = names[i];
            packs[i] = {raw[i], register_bytes};
            rows.push_back({.info = &infos[i],
                            .shape = form.shape,
                            .native32 = packs[i].f32.bound(),
                            .native64 = packs[i].f64.bound()});
        }
    }
    Table(const Table&) = delete;
    Table& operator=(const Table&) = delete;
};

}  // namespace

std::span<const Variant> variants() {
#if defined(__x86_64__)
    static const auto all = [] {
        std::vector<Variant> found;
        const auto isas = available_isas();
        if (std::ranges::find(isas, Isa::w256) == isas.end()) return found;
        static Table contract("contract", fill_variant_contract), fastmath("fastmath", fill_variant_fastmath);
        found.push_back({"contract", Isa::w256, contract.rows});
        found.push_back({"fastmath", Isa::w256, fastmath.rows});
        return found;
    }();
    return all;
#else
    return {};
#endif
}

}  // namespace lostbits::intersect::simd
