// The truth of cones against fractions, alone and in packs; every form when nothing is rounded; and what a cone says of
// itself.

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

TEST_CASE("packs say of cones what the truth of each ray says", "[truth][cone]") { check_packs_of(for_each_cone); }

TEST_CASE("every cone form solves the problem when nothing is rounded", "[intersect][cone][formula]") {
    check_unrounded<intersect::cone::ConeForms>(for_each_cone);
}

TEST_CASE("a cone's distance, normal and nearest point belong together", "[cone]") {
    Seeded rng(0xc0a);
    int inside = 0;
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
    const double share =
        largest_share_of_bound(rng, 2000, [&](const Vec<double>& from, const Vec<double>& to, double size) {
            return Cone<double>{from, to, size * rng.uniform(0.01, 1), size * rng.uniform(0, 1)};
        });
    CHECK(inside > 5);
    CHECK(share < 1);
    CHECK(share > 0.01);
}

}  // namespace lostbits::test::test_cone
