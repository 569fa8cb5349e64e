// The truth of capsules against fractions, alone and in packs; every form when nothing is rounded; and what a
// capsule says of itself.
#include <vector>

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
    std::vector<RayAndSolid> asked;
    for_each_capsule(static_cast<int>(draws(1500)), [&](const SampledRays<Capsule>&, const Sample<Capsule>& s) {
        asked.push_back({s.ray, s.solid});
    });
    check_packs_against_each_alone(asked);
}

TEST_CASE("every capsule form solves the problem when nothing is rounded", "[intersect][capsule][formula]") {
    UnroundedForms<intersect::capsule::CapsuleForms> forms;
    for_each_capsule(static_cast<int>(draws(1000)), [&](const SampledRays<Capsule>& family, const Sample<Capsule>& s) {
        const auto right = answer_of(s);
        forms.ask(family.name, s, right, right.is_within(0));
    });
    forms.check(150);
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
    double largest = 0;
    for (int i = 0; i < 4000; ++i) {
        const double scale = rng.magnitude(-6, 6), off = rng.magnitude(-6, 6);
        const Vec<double> place = off * rng.vec(-1, 1), v = scale * rng.vec(-1, 1), w = scale * rng.vec(-1, 1);
        const Capsule<double> c{place, place + v, scale * rng.uniform(0.01, 1)};
        const Vec<double> at = place + rng.unit() * v + w;
        if (testing::stored(c.start, binary32) == testing::stored(c.end, binary32)) continue;
        largest = std::max(largest, share_of_bound(c, at));
    }
    CHECK(largest < 1);
    CHECK(largest > 0.01);
}

}  // namespace lostbits::test::test_capsule
