// The truth of cones against fractions, alone and in packs; every form when nothing is rounded; and what a cone says of
// itself.
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/cone/cone_rays.hpp"
#include "intersect/packs_and_alone.hpp"
#include "intersect/solid_checks.hpp"

namespace lostbits::test::test_cone {

TEST_CASE("the truth of a cone is what fractions say", "[truth][cone]") {
    TruthTally truth;
    int steep = 0;
    for_each_cone(static_cast<int>(draws(1500)), [&](const SampledRays<Cone>& family, const Sample<Cone>& s) {
        const CappedAnswer right = answer_of(s);
        truth.hold(family.name, s, right);
        steep += right.a < 0;
    });
    truth.check_hits(cone_rays);
    for (const char* const touching : {"beside the side", "tangent", "through the apex", "through a rim", "in a cap"}) {
        INFO(touching);
        CHECK(truth.touches[touching] > 20);
    }
    CHECK(truth.from_it["from the surface"] > 50);
    CHECK(steep > 60);
    CHECK(truth.exact["random"] == 0);
}

TEST_CASE("packs say of cones what the truth of each ray says", "[truth][cone]") {
    std::vector<RayAndSolid> asked;
    for_each_cone(static_cast<int>(draws(1500)), [&](const SampledRays<Cone>&, const Sample<Cone>& s) {
        asked.push_back({s.ray, s.solid});
    });
    check_packs_against_each_alone(asked);
}

TEST_CASE("every cone form solves the problem when nothing is rounded", "[intersect][cone][formula]") {
    UnroundedForms<intersect::cone::ConeForms> forms;
    for_each_cone(static_cast<int>(draws(1000)), [&](const SampledRays<Cone>& family, const Sample<Cone>& s) {
        const CappedAnswer right = answer_of(s);
        forms.ask(family.name, s, right, right.is_within(0));
    });
    forms.check(150);
}

TEST_CASE("a cone's distance, normal and nearest point belong together", "[cone]") {
    Seeded rng(0xc0a);
    int inside = 0;
    double share = 0;
    for (int i = 0; i < 500; ++i) {
        const Cone<double> cone{rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1),
                                rng.coin() ? 0 : rng.uniform(0, 1)};
        const Vec<double> q = rng.vec(-2, 2);
        // At an apex there is no normal.
        const bool at_apex = cone.top_radius == 0 &&
                             length(Vec<Real>(in_real(cone).projected({}, lifted<Real>(q)) - lifted<Real>(cone.top))) <
                                 ldexp(Real(1), -180);
        if (!at_apex) check_nearest_point(cone, q);
        inside += cone.distance(q) < 0;
        // A distance is the least to a point of the surface: none of these is nearer.
        const Cone<Real> exact = in_real(cone);
        const Real d = abs(exact.distance(lifted<Real>(q)));
        for (int k = 0; k < 20; ++k) {
            const Vec<Real> other = exact.projected({}, lifted<Real>(rng.vec(-2, 2)));
            REQUIRE(length(Vec<Real>(lifted<Real>(q) - other)) >= d * (1 - ldexp(Real(1), -180)));
        }
    }
    for (int i = 0; i < 2000; ++i) {
        const double scale = rng.magnitude(-6, 6), off = rng.magnitude(-6, 6);
        const Vec<double> place = off * rng.vec(-1, 1), v = scale * rng.vec(-1, 1), w = scale * rng.vec(-1, 1);
        const Cone<double> cone{place, place + v, scale * rng.uniform(0.01, 1), scale * rng.uniform(0, 1)};
        if (testing::stored(cone.base, binary32) == testing::stored(cone.top, binary32)) continue;
        share = std::max(share, share_of_bound(cone, place + rng.unit() * v + w));
    }
    CHECK(inside > 5);
    CHECK(share < 1);
    CHECK(share > 0.01);
}

}  // namespace lostbits::test::test_cone
