// What the truth of a ray takes for each shape, in packs.
#include <array>
#include <cstdio>
#include <random>

#include "intersect/simd/packed.hpp"
#include "measure/truth/truth_columns.hpp"
#include "ratios.hpp"
#include "scene/sweep/families.hpp"

namespace bench {

namespace {

using namespace lostbits;
using measure::truth::ProblemColumns;
using measure::truth::Tightness;

/// The easy rays of a shape's family, at one solid.
struct ShapeSet {
    Shape shape;
    std::array<std::vector<double>, 6> wide;
    std::array<std::vector<float>, 6> narrow;
    Solid<double> solid;
    std::array<float, most_numbers> narrow_numbers{};

    explicit ShapeSet(const scene::rays::RayGroup& group)
        : shape(group.solids.front().shape), solid(group.solids.front()) {
        std::mt19937_64 engine(20261126);
        for (std::size_t i = 0; i < group.rays.size(); ++i) {
            const Ray<double> ray = group.rays[i];
            for (int k = 0; k < 6; ++k) {
                const double x = k < 3 ? ray.origin[k] : ray.direction[k - 3];
                narrow[static_cast<std::size_t>(k)].push_back(static_cast<float>(x));
                // 29 more bits, below those of a float.
                const double more = 1 + static_cast<double>(engine() >> 35) * 0x1p-53;
                wide[static_cast<std::size_t>(k)].push_back(x * more);
            }
        }
        for (std::size_t k = 0; k < solid.used().size(); ++k) narrow_numbers[k] = static_cast<float>(solid.numbers[k]);
    }
    template <class S>
    [[nodiscard]] ProblemColumns<S> problems() const {
        ProblemColumns<S> p{.size = narrow[0].size(), .ray = {}, .shape = shape, .solid = {}};
        for (std::size_t k = 0; k < 6; ++k) {
            if constexpr (sizeof(S) == 4) p.ray[k] = narrow[k];
            else p.ray[k] = wide[k];
        }
        for (std::size_t k = 0; k < solid.used().size(); ++k) {
            if constexpr (sizeof(S) == 4) p.solid[k] = std::span(&narrow_numbers[k], 1);
            else p.solid[k] = std::span(&solid.numbers[k], 1);
        }
        return p;
    }
};

}  // namespace

void print_truth_of_shapes() {
    std::vector<ShapeSet> sets;
    for (const auto& family : scene::sweep::families()) sets.emplace_back(family.timed().hits);
    std::printf("%-12s %14s %14s   rays that hit, one solid, packs of %s\n", "truth", "24 bits, ns", "53 bits, ns",
                std::string(name_of(intersect::simd::current_isa())).c_str());
    for (const ShapeSet& set : sets) {
        static measure::truth::TruthColumns out;
        const std::vector<lostbits::measure::speed::TimedWork> work{
            {[&set] { find_truth_columns(set.problems<float>(), {.tightness = Tightness::ulps_of_binary32}, out); },
             set.narrow[0].size(), true},
            {[&set] { find_truth_columns(set.problems<double>(), {}, out); }, set.narrow[0].size(), true}};
        const auto samples = measure::speed::sample_interleaved(work, {.repetitions = 15});
        std::printf("%-12s", std::string(name_of(set.shape)).c_str());
        for (const auto& sample : samples) std::printf(" %14.1f", 1e9 * measure::speed::timing_of(sample).median);
        std::printf("\n");
    }
    std::printf("\n");
}

}  // namespace bench
