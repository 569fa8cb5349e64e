// Corrections that are zero without rounding (a Newton step, a second solution) must still go the right way with
// rounding, which exact tests cannot show.
#include <cmath>
#include <map>
#include <string_view>

#include "catch.hpp"
#include "intersect/ask_row.hpp"
#include "measure/seeded.hpp"
#include "number/real.hpp"
#include "shapes/lift.hpp"
#include "shapes/sphere/forms/unified.hpp"

namespace lostbits::test {
namespace {

/// The mean relative error of t in float over rays from outside that hit, in units of 2^-24, by forms that hit too.
std::map<std::string_view, double> mean_errors(double nearest, double farthest) {
    struct Sum {
        double errors = 0;
        int hits = 0;
    };
    std::map<std::string_view, Sum> sums;
    test::Seeded rng(0xacc);
    for (int i = 0; i < 400; ++i) {
        const auto stored = [](const Vec<double>& v) { return test::stored(v, binary32); };
        const Vec<double> centre = stored(rng.vec(-3, 3)), towards = rng.vec(-1, 1), side = rng.vec(-1, 1);
        const double radius = static_cast<float>(rng.uniform(0.25, 4));
        const double away = radius * rng.uniform(nearest, farthest) / length(towards);
        const Vec<double> origin = stored(centre - away * towards);
        const Vec<double> aim = centre + 0.6 * radius * side - origin;
        const Ray<double> ray{origin, stored((1 / length(aim)) * aim)};
        const Sphere<double> sphere{centre, radius};
        const Hit<Real> want = intersect::sphere::Unified::intersect(
            lift_ray<Real>(ray), Sphere<Real>{lift_vec<Real>(centre), Real(radius)});
        if (!want.hit) continue;
        for (const auto& row : intersect::table::intersectors(Shape::sphere)) {
            const Hit<float> h =
                ask_row<float>(row, lift_ray<float>(ray), lift_primitive<float>(Primitive<double>(sphere)));
            if (!h.hit || !std::isfinite(h.t)) continue;
            Sum& sum = sums[row.info->name];
            sum.errors += Real(abs(Real(h.t) - want.t) / abs(want.t)).convert_to<double>() * 0x1p24, ++sum.hits;
        }
    }
    std::map<std::string_view, double> means;
    for (const auto& [name, sum] : sums)
        if (sum.hits > 50) means[name] = sum.errors / sum.hits;  // at 10⁶ radii some forms hit next to nothing in float
    return means;
}

}  // namespace

TEST_CASE("no form loses more than a few bits on ordinary rays, and corrections reduce the loss",
          "[intersect][accuracy]") {
    const auto near = mean_errors(1.01, 10), far = mean_errors(1e6, 2e6);
    CHECK(near.size() == intersect::table::intersectors(Shape::sphere).size());
    for (const auto& [name, mean] : near) {
        INFO(name << " is off by " << mean << " units of 2^-24");
        CHECK(mean > 0);
        CHECK(mean < 64);
    }
    // The second solution and the moved origin are for distance; the Newton step removes the errors of the roots.
    CHECK(far.at("sphere.two_step") < far.at("sphere.half_b") / 100);
    CHECK(far.at("sphere.closest_approach") < far.at("sphere.half_b") / 100);
    CHECK(near.at("sphere.newton_refined") < 1.1 * near.at("sphere.unified"));
}

}  // namespace lostbits::test
