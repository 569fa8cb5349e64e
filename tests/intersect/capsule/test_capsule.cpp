// The truth of capsules against fractions, alone and in packs; every form when nothing is rounded; and what a
// capsule says of itself.

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/capsule/capsule_rays.hpp"
#include "intersect/packs_and_alone.hpp"
#include "intersect/solid_checks.hpp"

namespace lostbits::test::test_capsule {

TEST_CASE("the truth of a capsule is what fractions say", "[truth][capsule]") {
    TruthTally truth;
    for_each_capsule(static_cast<int>(draws(1500)), [&](const SampledRays<Capsule>& family, const Sample<Capsule>& s) {
        truth.hold(family.name, s, answer_of(s));
    });
    truth.check_hits(capsule_rays);
    CHECK(truth.touches["beside the axis"] > 20);
    CHECK(truth.touches["tangent"] > 20);
    CHECK(truth.touches["tangent at an end"] > 100);
    CHECK(truth.from_it["through a seam"] > 0);
    CHECK(truth.exact["random"] == 0);
}

TEST_CASE("packs say of capsules what the truth of each ray says", "[truth][capsule]") {
    check_packs_of(for_each_capsule);
}

TEST_CASE("every capsule form solves the problem when nothing is rounded", "[intersect][capsule][formula]") {
    check_unrounded<intersect::capsule::CapsuleForms>(for_each_capsule);
}

TEST_CASE("a capsule's distance, normal and nearest point belong together", "[capsule]") {
    Seeded rng(0x7a7);
    int inside = 0;
    for (int i = 0; i < 500; ++i) {
        const Capsule<double> c{rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)};
        const Vec<double> q = rng.vec(-2, 2);
        inside += check_nearest_of_solid(c, q, false);
        const Vec<Real> u = lifted<Real>(Vec<double>(rng.unit(), 0.5, 0.5));
        const Capsule<Real> exact = in_real(c);
        REQUIRE(exact.distance(exact.point_at(u)) <= ldexp(Real(1), -200));
    }
    CHECK(inside > 5);
}

TEST_CASE("the point of a ray put onto a capsule lies within its bound", "[capsule]") {
    Seeded rng(0x7a8);
    const double largest =
        largest_share_of_bound(rng, 4000, [&](const Vec<double>& from, const Vec<double>& to, double size) {
            return Capsule<double>{from, to, size * rng.uniform(0.01, 1)};
        });
    CHECK(largest < 1);
    CHECK(largest > 0.01);
}

}  // namespace lostbits::test::test_capsule
