// What errors of the inputs can move t by at a solid under a matrix whose numbers are far apart, in 2048 bits.
#include <array>
#include <cmath>
#include <optional>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/seeded.hpp"
#include "measure/truth/ray_families.hpp"
#include "measure/truth/reach.hpp"
#include "measure/truth/truth.hpp"

namespace test_reach_placed {

using namespace lostbits;
using measure::truth::reach;
using testing::Seeded;

namespace {

using Wide = BasicReal<2048>;

double half_ulp_of(double x, const FloatFormat& format) {
    const int e = x == 0 ? format.emin : std::max(std::ilogb(x), format.emin);
    return std::ldexp(1.0, e - format.precision);
}

/// The near root of a sphere under a matrix: the ray by Cramer's rule, x the numbers of the ray, the sphere, and the
/// matrix row by row.
std::optional<Wide> near_root_under(const std::array<Wide, 22>& x) {
    const auto row = [&x](std::size_t k) { return Vec<Wide>(x[10 + k], x[11 + k], x[12 + k]); };
    const Vec<Wide> a = row(0), b = row(4), c = row(8), shift(x[13], x[17], x[21]);
    const std::array<Vec<Wide>, 3> columns{cross(b, c), cross(c, a), cross(a, b)};
    const Wide det = dot(a, cross(b, c));
    const auto back = [&](const Vec<Wide>& v) {
        const Vec<Wide> scaled = v.x * columns[0] + v.y * columns[1] + v.z * columns[2];
        return Vec<Wide>(scaled.x / det, scaled.y / det, scaled.z / det);
    };
    const Vec<Wide> o(x[0], x[1], x[2]), d = back({x[3], x[4], x[5]});
    const Vec<Wide> f = back(Vec<Wide>(o - shift)) - Vec<Wide>(x[6], x[7], x[8]);
    const Wide aa = dot(d, d), h = dot(f, d), q = h * h - aa * (dot(f, f) - x[9] * x[9]);
    if (q < 0) return std::nullopt;
    return Wide((-h - sqrt(q)) / aa);
}

}  // namespace

TEST_CASE("t moves no further than it can reach - under matrices whose numbers are far apart", "[reach]") {
    int trials = 0, known = 0, near = 0;
    for (const FloatFormat& format : {binary32, binary64}) {
        Seeded rng(0x5ca1e);
        for (int i = 0; i < test::draws(20000); ++i) {
            Solid<double> solid(Sphere<double>{rng.vec(-2, 2), rng.uniform(0.5, 2)});
            // Turns by half a turn leave numbers like these where others are 1; scales are as small.
            std::array<double, 12> m{};
            const int size = static_cast<int>(rng.integer(-50, 50));
            for (double& x : m) x = rng.signed_magnitude(size - (i % 2 ? 70 : 50), size - (i % 2 ? 50 : 20));
            for (const std::size_t k : {0, 5, 10}) m[k] = rng.signed_magnitude(size - 1, size + 1);
            const auto stored = [&format](double x) { return testing::stored(x, format); };
            solid.placed = transformed(Placement<double>{m, false, 1}, stored);
            solid = transformed(solid, stored);
            const Vec<double> from = std::ldexp(1.0, size) * rng.vec(-8, 8),
                              at = solid.placed->map().point(solid.point(0));
            const Ray<double> ray{testing::stored(at + from, format),
                                  testing::stored(-from + std::ldexp(0.5, size) * rng.vec(-1, 1), format)};
            const auto truth = measure::truth::find_truth(ray, solid);
            if (!truth.is_hit() || truth.t.is_zero()) continue;
            std::array<Wide, 22> x;
            std::array<double, 22> step{};
            for (int k = 0; k < 3; ++k)
                x[static_cast<std::size_t>(k)] = ray.origin[k], x[static_cast<std::size_t>(3 + k)] = ray.direction[k];
            for (std::size_t k = 0; k < 4; ++k) x[6 + k] = solid.numbers[k];
            for (std::size_t k = 0; k < 12; ++k) x[10 + k] = solid.placed->matrix[k];
            for (std::size_t k = 0; k < 22; ++k) step[k] = half_ulp_of(static_cast<double>(x[k]), format);
            const auto t = near_root_under(x);
            if (!t || *t <= 0) continue;
            ++trials;
            const double bound = reach(ray, solid, truth.t, format);
            if (!std::isfinite(bound)) continue;
            ++known;
            Wide most = 0;
            for (int k = 0; k < 6; ++k) {
                auto moved = x;
                for (std::size_t j = 0; j < 22; ++j) moved[j] += step[j] * (k % 2 ? rng.sign() : rng.uniform(-1, 1));
                if (const auto other = near_root_under(moved)) most = std::max(most, Wide(abs(Wide(*other - *t))));
            }
            CHECK(most <= Wide(bound));
            near += most > Wide(bound) / 64;
        }
    }
    CHECK(trials > 500);
    CHECK(known > trials * 9 / 10);
    CHECK(near > trials / 2);
}

}  // namespace test_reach_placed
