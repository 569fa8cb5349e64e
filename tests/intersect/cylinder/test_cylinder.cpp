// The truth of cylinders against fractions, alone and in packs; every form when nothing is rounded; and what a
// cylinder says of itself.

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/cylinder/cylinder_rays.hpp"
#include "intersect/packs_and_alone.hpp"
#include "intersect/solid_checks.hpp"

namespace lostbits::test::test_cylinder {

TEST_CASE("the truth of a cylinder is what fractions say", "[truth][cylinder]") {
    TruthTally truth;
    for_each_cylinder(static_cast<int>(draws(1500)),
                      [&](const SampledRays<Cylinder>& family, const Sample<Cylinder>& s) {
                          truth.hold(family.name, s, answer_of(s));
                      });
    truth.check_hits(cylinder_rays);
    CHECK(truth.touches["beside the axis"] > 20);
    CHECK(truth.touches["tangent"] > 20);
    CHECK(truth.touches["through a rim"] > 20);
    CHECK(truth.touches["in a cap"] > 20);
    CHECK(truth.from_it["from the surface"] > 50);
    CHECK(truth.exact["random"] == 0);
}

TEST_CASE("packs say of cylinders what the truth of each ray says", "[truth][cylinder]") {
    check_packs_of(for_each_cylinder);
}

TEST_CASE("every cylinder form solves the problem when nothing is rounded", "[intersect][cylinder][formula]") {
    check_unrounded<intersect::cylinder::CylinderForms>(for_each_cylinder);
}

TEST_CASE("a cylinder's distance, normal and nearest point belong together", "[cylinder]") {
    Seeded rng(0x7a7);
    int inside = 0, rims = 0;
    for (int i = 0; i < 500; ++i) {
        const Cylinder<double> c{rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)};
        const Vec<double> q = rng.vec(-2, 2), v = c.top - c.base, f = q - c.base;
        const double along = lostbits::dot(v, f), v2 = square(v);
        const bool on_rim = (along < 0 || along > v2) && length(lostbits::cross(v, f)) > c.radius * std::sqrt(v2);
        inside += check_nearest_of_solid(c, q, on_rim), rims += on_rim;
        const Vec<Real> u = lifted<Real>(Vec<double>(rng.unit(), 0.5, 0.5));
        const Cylinder<Real> exact = in_real(c);
        REQUIRE(exact.distance(exact.point_at(u)) <= ldexp(Real(1), -200));
    }
    CHECK(inside > 5);
    CHECK(rims > 20);
    CHECK(rims < 400);
}

TEST_CASE("the point of a ray put onto a cylinder lies within its bound", "[cylinder]") {
    Seeded rng(0x7a8);
    const double largest =
        largest_share_of_bound(rng, 4000, [&](const Vec<double>& from, const Vec<double>& to, double size) {
            return Cylinder<double>{from, to, size * rng.uniform(0.01, 1)};
        });
    CHECK(largest < 1);
    CHECK(largest > 0.01);
}

}  // namespace lostbits::test::test_cylinder
