// Compares the truth of rays at one triangle, in packs, with the exact predicates of CGAL that make the same decision.
// All are measured in one run: compare ratios, not times. The truth also has t, with a relative error of at most 2^-33
// for binary32 and 2^-72 for binary64; the predicates have only the decision.
//
//   build/bench/bench_triangle
//   build/bench/bench_triangle --ratios     forms in packs, as ratios to loops written by hand
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>

#include "intersect/simd/packed.hpp"
#include "measure/trade/timing_work.hpp"
#include "measure/truth/truth_columns.hpp"
#include "predicates.hpp"
#include "ratios.hpp"

namespace {

using namespace lostbits;
using measure::truth::ProblemColumns;
using measure::truth::Tightness;

constexpr std::size_t ray_count = 4096;

/// Target of the rays. `inside`: every second ray passes through the inside, the others inside or outside. `near_edge`:
/// all pass through the grid point nearest to a point of an edge. `edge`: all pass exactly through an edge.
enum class RayTarget { inside, near_edge, edge };

/// Rays and a triangle with numbers on a grid. The grid is coarse enough for origin + direction to be exact in double,
/// since the predicates take that point.
template <class S>
struct RaysAtTriangle {
    std::array<std::vector<S>, 6> columns;
    std::array<S, 9> numbers;
    std::vector<bench::RayOfPoints> rays;
    std::array<bench::Point, 3> corners;

    /// Each coordinate of an origin is within `distance` of 0.
    RaysAtTriangle(double distance, RayTarget target) {
        const double step = std::ldexp(1, (sizeof(S) == 4 ? -21 : -50) + std::ilogb(distance));
        const auto round_to_grid = [step](double x) { return std::nearbyint(x / step) * step; };
        constexpr double part_count = 64;  // an edge is cut at grid points
        std::mt19937_64 engine(20261127);
        const auto between = [&engine](double lo, double hi) {
            return lo + (hi - lo) * static_cast<double>(engine() >> 11) * 0x1p-53;
        };
        const bench::Point unrounded_corners[3] = {{-0.9, -0.7, 0.4}, {0.8, -0.5, -0.3}, {0.1, 0.9, -0.2}};
        for (std::size_t v = 0; v < 3; ++v)
            for (std::size_t k = 0; k < 3; ++k) {
                corners[v][k] = part_count * round_to_grid(unrounded_corners[v][k] / part_count);
                numbers[3 * v + k] = static_cast<S>(corners[v][k]);
            }
        for (std::size_t i = 0; i < ray_count; ++i) {
            double u = between(0, 1), v = between(0, 1);
            if (target == RayTarget::edge) u = std::nearbyint(u * part_count) / part_count;
            if (target != RayTarget::inside) v = 0;
            else if (i % 2 == 0 && u + v > 1) u = 1 - u, v = 1 - v;
            const std::size_t first = i % 3;
            bench::RayOfPoints ray;
            for (std::size_t k = 0; k < 3; ++k) {
                const double a = corners[first][k], b = corners[(first + 1) % 3][k], c = corners[(first + 2) % 3][k];
                ray.from[k] = round_to_grid(between(-distance, distance));
                ray.through[k] = round_to_grid(a + u * (b - a) + v * (c - a));
                columns[k].push_back(static_cast<S>(ray.from[k]));
                columns[k + 3].push_back(static_cast<S>(ray.through[k] - ray.from[k]));
            }
            rays.push_back(ray);
        }
    }
    [[nodiscard]] ProblemColumns<S> problems() const {
        ProblemColumns<S> p{.size = ray_count, .ray = {}, .shape = Shape::triangle, .primitive = {}};
        for (std::size_t k = 0; k < 6; ++k) p.ray[k] = columns[k];
        for (std::size_t k = 0; k < 9; ++k) p.primitive[k] = std::span(&numbers[k], 1);
        return p;
    }
};

/// Prints a row. Returns false if a decision differs.
template <class S>
bool print_row(const char* name, double distance, RayTarget target) {
    const RaysAtTriangle<S> set(distance, target);
    static measure::truth::TruthColumns truth;
    std::vector<unsigned char> orientation_hits(ray_count), intersect_hits(ray_count);
    const auto problems = set.problems();
    const auto tightness = sizeof(S) == 4 ? Tightness::ulps_of_binary32 : Tightness::certified;
    const auto find_truths = [&] { find_truth_columns(problems, {.tightness = tightness}, truth); };
    std::vector<measure::trade::TimedWork> work{
        {[&] { decide_by_orientations(set.rays, set.corners, orientation_hits); }, ray_count, true},
        {[&] { decide_by_do_intersect(set.rays, set.corners, intersect_hits); }, ray_count, true},
        {find_truths, ray_count, true}};
    const auto samples = measure::trade::sample_interleaved(work, {.repetitions = 31});
    std::size_t hit_count = 0, difference_count = 0;
    for (std::size_t i = 0; i < ray_count; ++i) {
        const bool is_hit = truth.decision[i] == measure::truth::Truth::Decision::hit;
        hit_count += is_hit;
        difference_count += is_hit != (orientation_hits[i] != 0);
    }
    std::printf("%-8s %-10s %6zu %12.1f %12.1f %12.1f", sizeof(S) == 4 ? "binary32" : "binary64", name, hit_count,
                1e9 * measure::trade::summarise_samples(samples[0]).median,
                1e9 * measure::trade::summarise_samples(samples[1]).median,
                1e9 * measure::trade::summarise_samples(samples[2]).median);
    for (const std::size_t rival : {0, 1})
        std::printf(" %13.2f", measure::trade::summarise_ratios(samples[rival], samples[2]).median);
    std::printf("   %llu %llu\n", static_cast<unsigned long long>(truth.stages.binary64),
                static_cast<unsigned long long>(truth.stages.double_double));
    if (difference_count != 0)
        std::printf("  %zu decisions differ from those of decide_by_orientations\n", difference_count);
    return difference_count == 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 2 && std::string_view(argv[1]) == "--ratios") {
        bench::print_rays(Shape::triangle, {"triangle.moller_trumbore", "triangle.undivided", "triangle.woop"});
        return 0;
    }
    intersect::simd::set_isa(intersect::simd::Isa::w256);
    std::printf("%-8s %-10s %6s %12s %12s %12s %13s %13s   %s\n", "numbers", "rays", "hits", "orient., ns",
                "do_int., ns", "truth, ns", "orient./truth", "do_int./truth",
                "rays settled by binary64 and double-double, of 4096");
    bool same = true;
    for (const auto& [name, distance, target] : {std::tuple{"near", 4.0, RayTarget::inside},
                                                 {"100 away", 128.0, RayTarget::inside},
                                                 {"edges", 4.0, RayTarget::near_edge},
                                                 {"on edges", 4.0, RayTarget::edge}}) {
        same = print_row<float>(name, distance, target) && same;
        same = print_row<double>(name, distance, target) && same;
    }
    return same ? 0 : 1;
}
