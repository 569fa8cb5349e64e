// Measures the truth of a ray for each shape, in packs.
#include <array>
#include <cstdio>
#include <optional>
#include <random>

#include "intersect/simd/packed.hpp"
#include "measure/truth/truth_columns.hpp"
#include "ratios.hpp"
#include "scene/sweep/distributions.hpp"

namespace bench {

namespace {

using namespace lostbits;
using measure::truth::ProblemColumns;
using measure::truth::Tightness;

/// A transform: rotation about (1, 2, 2) with cosine 3/5, scale 1.5, and a translation. Its numbers are rounded to
/// binary32.
Transform<double> turned() {
    const Transform<double> transform{{0.9666667, -0.6666667, 0.9333333, 12, 0.9333333, 1.1666667, -0.1333333, -7,
                                       -0.6666667, 0.6666667, 1.1666667, 5},
                                      false,
                                      1};
    return convert_numbers(transform, [](double x) { return static_cast<double>(static_cast<float>(x)); });
}

/// The easy rays of a shape's ray distribution at one primitive, or the same with a transform.
struct ShapeSet {
    Shape shape;
    std::array<std::vector<double>, 6> wide;
    std::array<std::vector<float>, 6> narrow;
    Primitive<double> primitive;
    std::array<float, max_primitive_number_count> narrow_numbers{};

    ShapeSet(const scene::rays::RayGroup& group, std::optional<Transform<double>> transform)
        : shape(group.primitives.front().shape), primitive(group.primitives.front()) {
        primitive.transform = transform;
        std::mt19937_64 engine(20261126);
        for (std::size_t i = 0; i < group.rays.size(); ++i) {
            Ray<double> ray = group.rays[i];
            if (transform) ray = {transform->map().point(ray.origin), transform->map().linear(ray.direction)};
            for (int k = 0; k < 6; ++k) {
                const double x = k < 3 ? ray.origin[k] : ray.direction[k - 3];
                narrow[k].push_back(static_cast<float>(x));
                // Adds 29 bits below those of a float.
                const double more = 1 + static_cast<double>(engine() >> 35) * 0x1p-53;
                wide[k].push_back(x * more);
            }
        }
        for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k)
            narrow_numbers[k] = static_cast<float>(primitive.numbers[k]);
        for (std::size_t k = max_number_count; transform && k < max_primitive_number_count; ++k)
            narrow_numbers[k] = static_cast<float>(transform->matrix[k - max_number_count]);
    }
    template <class S>
    [[nodiscard]] ProblemColumns<S> problems() const {
        ProblemColumns<S> p{.size = narrow[0].size(), .ray = {}, .shape = shape, .primitive = {}};
        for (std::size_t k = 0; k < 6; ++k) {
            if constexpr (sizeof(S) == 4) p.ray[k] = narrow[k];
            else p.ray[k] = wide[k];
        }
        for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k) {
            if constexpr (sizeof(S) == 4) p.primitive[k] = std::span(&narrow_numbers[k], 1);
            else p.primitive[k] = std::span(&primitive.numbers[k], 1);
        }
        for (std::size_t k = max_number_count; primitive.transform && k < max_primitive_number_count; ++k) {
            if constexpr (sizeof(S) == 4) p.primitive[k] = std::span(&narrow_numbers[k], 1);
            else p.primitive[k] = std::span(&primitive.transform->matrix[k - max_number_count], 1);
        }
        if (primitive.transform) p.matrix = {true, false, primitive.transform->orientation};
        return p;
    }
};

}  // namespace

void print_truth_of_shapes() {
    struct Pair {
        ShapeSet own, transformed;
    };
    std::vector<Pair> sets;
    for (const auto& distribution : scene::sweep::distributions()) {
        const auto hits = distribution.draw_timed_rays().hits;
        sets.push_back({ShapeSet(hits, std::nullopt), ShapeSet(hits, turned())});
    }
    std::printf("%-12s %14s %14s %14s %14s %14s %14s   rays that hit, one primitive, packs of %s\n", "truth",
                "24 bits, ns", "53 bits, ns", "with a transform", "53 bits, ns", "times, 24", "times, 53",
                std::string(name_of(intersect::simd::current_isa())).c_str());
    for (const auto& [own, transformed] : sets) {
        static measure::truth::TruthColumns out;
        std::vector<measure::trade::TimedWork> work;
        for (const ShapeSet* const set : {&own, &transformed}) {
            const std::size_t rays = set->narrow[0].size();
            work.push_back(
                {[set] { find_truth_columns(set->problems<float>(), {.tightness = Tightness::ulps_of_binary32}, out); },
                 rays, true});
            work.push_back({[set] { find_truth_columns(set->problems<double>(), {}, out); }, rays, true});
        }
        const auto samples = measure::trade::sample_interleaved(work, {.repetitions = 15});
        std::printf("%-12s", std::string(name_of(own.shape)).c_str());
        for (const auto& sample : samples)
            std::printf(" %14.1f", 1e9 * measure::trade::summarise_samples(sample).median);
        for (const std::size_t k : {0, 1})
            std::printf(" %14.2f", measure::trade::summarise_ratios(samples[k + 2], samples[k]).median);
        std::printf("\n");
    }
    std::printf("\n");
}

}  // namespace bench
