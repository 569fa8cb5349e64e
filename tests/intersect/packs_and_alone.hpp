// Many rays, each with a solid of its own, in packs and one by one.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/truth/truth.hpp"
#include "measure/truth/truth_columns.hpp"

namespace lostbits::test {

struct RayAndSolid {
    Ray<double> ray;
    Solid<double> solid;
};

/// Numbers of binary32 and solids of one shape: with every instruction set a pack decides as `find_truth` does, and a
/// third or more of the rays in doubles.
inline void check_packs_against_each_alone(const std::vector<RayAndSolid>& asked) {
    const Shape shape = asked.at(0).solid.shape;
    const std::size_t count = row_of(shape).numbers;
    std::array<std::vector<float>, 6> ray;
    std::array<std::vector<float>, most_numbers> solid;
    for (const RayAndSolid& one : asked) {
        for (std::size_t k = 0; k < 3; ++k) {
            ray[k].push_back(static_cast<float>(one.ray.origin[static_cast<int>(k)]));
            ray[k + 3].push_back(static_cast<float>(one.ray.direction[static_cast<int>(k)]));
        }
        for (std::size_t k = 0; k < count; ++k) solid[k].push_back(static_cast<float>(one.solid.numbers[k]));
    }
    measure::truth::ProblemColumns<float> p{.size = asked.size(), .ray = {}, .shape = shape, .solid = {}};
    for (std::size_t k = 0; k < 6; ++k) p.ray[k] = ray[k];
    for (std::size_t k = 0; k < count; ++k) p.solid[k] = solid[k];
    const auto before = intersect::simd::current_isa();
    for (const auto isa : intersect::simd::available_isas()) {
        intersect::simd::set_isa(isa);
        measure::truth::TruthColumns found;
        find_truth_columns(p, {.tightness = measure::truth::Tightness::ulps_of_binary32}, found);
        int different = 0;
        for (std::size_t i = 0; i < asked.size(); ++i)
            different += found.decision[i] != measure::truth::find_truth(asked[i].ray, asked[i].solid).decision;
        CHECK(different == 0);
        CHECK(found.stages.binary64 > asked.size() / 3);
    }
    intersect::simd::set_isa(before);
}

/// The same of samples (`ForEachSample`), of what `made` makes of the solid of each.
template <class ForEach, class Made = std::identity>
void check_packs_of(const ForEach& for_each, const Made& made = {}) {
    std::vector<RayAndSolid> asked;
    for_each(static_cast<int>(draws(1500)), [&](const auto&, const auto& s) {
        asked.push_back({s.ray, made(s.solid)});
    });
    check_packs_against_each_alone(asked);
}

}  // namespace lostbits::test
