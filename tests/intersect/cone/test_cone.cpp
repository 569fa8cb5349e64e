// The truth of cones against fractions, alone and in packs; every form when nothing is rounded; and what a cone says of
// itself.
#include <map>
#include <string>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/cone/cone_rays.hpp"
#include "intersect/packs_and_alone.hpp"
#include "intersect/solid_checks.hpp"

namespace lostbits::test::test_cone {

using intersect::AtOrigin;
using intersect::Touching;
using measure::truth::find_truth;
using measure::truth::Truth;

TEST_CASE("the truth of a cone is what fractions say", "[truth][cone]") {
    std::map<std::string, int> hits, touches, from_it, exact, opens;
    for_each_cone(static_cast<int>(draws(1500)), [&](const ConeRays& family, const ConeSample& s) {
        INFO(family.name);
        CAPTURE(s.ray.origin.x, s.ray.origin.y, s.ray.origin.z, s.ray.direction.x, s.ray.direction.y, s.ray.direction.z,
                s.cone.base.x, s.cone.base.y, s.cone.base.z, s.cone.top.x, s.cone.top.y, s.cone.top.z,
                s.cone.base_radius, s.cone.top_radius);
        const CappedAnswer right = answer_of(s);
        const Truth closed = find_truth(s.ray, Solid<double>(s.cone));
        REQUIRE(closed.decision == (right.meets() ? Truth::Decision::hit : Truth::Decision::miss));
        hits[family.name] += right.meets(), exact[family.name] += closed.bits > 106, opens[family.name] += right.a < 0;
        if (!right.meets()) return;
        const bool on_surface = right.holds(0) && !right.is_within(0);
        REQUIRE(closed.touches == !right.goes_through());
        REQUIRE(closed.on_surface == on_surface);
        touches[family.name] += closed.touches, from_it[family.name] += on_surface;
        REQUIRE(encloses_first(closed.t, right));
        const Truth open = find_truth(s.ray, Solid<double>(s.cone), {}, Touching::miss);
        REQUIRE(open.is_hit() == right.goes_through());
        if (!on_surface) return;
        // Whoever passes over its origin meets the other end, if it lies ahead.
        const Truth passed = find_truth(s.ray, Solid<double>(s.cone), {}, AtOrigin::miss);
        if (right.goes_through()) REQUIRE(passed.is_hit() == right.is_within(power_of_two(-60)));
    });
    for (const ConeRays& family : cone_rays) {
        INFO(family.name << ": hits " << hits[family.name] << ", touches " << touches[family.name] << ", from it "
                         << from_it[family.name] << ", by intervals " << exact[family.name]);
        CHECK(hits[family.name] > 20);
    }
    for (const char* const touching : {"beside the side", "tangent", "through the apex", "through a rim", "in a cap"}) {
        INFO(touching);
        CHECK(touches[touching] > 20);
    }
    CHECK(from_it["from the surface"] > 50);
    CHECK(opens["steep"] > 60);
    CHECK(exact["random"] == 0);
}

TEST_CASE("packs say of cones what the truth of each ray says", "[truth][cone]") {
    std::vector<RayAndSolid> asked;
    for_each_cone(static_cast<int>(draws(1500)), [&](const ConeRays&, const ConeSample& s) {
        asked.push_back({s.ray, s.cone});
    });
    check_packs_against_each_alone(asked);
}

TEST_CASE("every cone form solves the problem when nothing is rounded", "[intersect][cone][formula]") {
    UnroundedForms<intersect::cone::ConeForms> forms;
    for_each_cone(static_cast<int>(draws(1000)), [&](const ConeRays& family, const ConeSample& s) {
        const CappedAnswer right = answer_of(s);
        forms.ask(family.name, s.ray, in_real(s.cone), right, right.is_within(0));
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
