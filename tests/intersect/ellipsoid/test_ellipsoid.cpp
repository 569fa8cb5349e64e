// The truth of ellipsoids against fractions, alone and in packs; every form when nothing is rounded; and what an
// ellipsoid says of itself.
#include <map>
#include <string>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/ellipsoid/ellipsoid_rays.hpp"
#include "intersect/packs_and_alone.hpp"
#include "intersect/solid_checks.hpp"

namespace lostbits::test::test_ellipsoid {

using intersect::AtOrigin;
using intersect::Touching;
using measure::truth::find_truth;
using measure::truth::Truth;

namespace {

using test::lifted;  // beside that of the shape

template <class T>
Ellipsoid<T> lifted(const Ellipsoid<double>& e) {
    return {lifted<T>(e.centre), lifted<T>(e.radii)};
}

}  // namespace

TEST_CASE("the truth of an ellipsoid is what fractions say", "[truth][ellipsoid]") {
    std::map<std::string, int> hits, touches, from_it, exact;
    for_each_ellipsoid(
        static_cast<int>(draws(2000)), [&](const SampledRays<Ellipsoid>& family, const Sample<Ellipsoid>& s) {
            INFO(family.name);
            const EllipsoidAnswer right = answer_of(s);
            const Truth closed = find_truth(s.ray, Solid<double>(s.solid));
            REQUIRE(closed.decision == (right.meets() ? Truth::Decision::hit : Truth::Decision::miss));
            hits[family.name] += right.meets(), exact[family.name] += closed.bits > 106;
            if (!right.meets()) return;
            REQUIRE(closed.touches == right.touches());
            REQUIRE(closed.on_surface == (right.c == 0));
            touches[family.name] += right.touches(), from_it[family.name] += right.c == 0;
            REQUIRE(find_truth(s.ray, Solid<double>(s.solid), {}, Touching::miss).is_hit() == !right.touches());
            REQUIRE(encloses_first(closed.t, right));
            if (right.c == 0) {
                const Truth passed = find_truth(s.ray, Solid<double>(s.solid), {}, AtOrigin::miss);
                REQUIRE(passed.is_hit() == (right.h < 0));
            }
        });
    for (const SampledRays<Ellipsoid>& family : ellipsoid_rays) {
        INFO(family.name << ": hits " << hits[family.name] << ", by intervals " << exact[family.name]);
        CHECK(hits[family.name] > 20);
    }
    CHECK(touches["tangent"] > 50);
    CHECK(from_it["from the surface"] > 50);
    CHECK(exact["random"] == 0);
}

TEST_CASE("packs say of ellipsoids what the truth of each ray says", "[truth][ellipsoid]") {
    check_packs_of(for_each_ellipsoid);
}

TEST_CASE("every ellipsoid form solves the problem when nothing is rounded", "[intersect][ellipsoid][formula]") {
    UnroundedForms<intersect::ellipsoid::EllipsoidForms> forms(-180);
    for_each_ellipsoid(static_cast<int>(draws(1000)),
                       [&](const SampledRays<Ellipsoid>& family, const Sample<Ellipsoid>& s) {
                           const EllipsoidAnswer right = answer_of(s);
                           forms.ask(family.name, s, right, right.c < 0);
                       });
    forms.check(200);
}

TEST_CASE("an ellipsoid with equal radii is the sphere", "[ellipsoid]") {
    Seeded rng(0x7a3);
    for (int i = 0; i < 500; ++i) {
        const Vec<double> centre = rng.vec(-1, 1), p = rng.vec(-3, 3), d = rng.vec(-1, 1);
        const double r = rng.uniform(0.1, 2);
        const Ray<Real> ray{lifted<Real>(p), lifted<Real>(d)};
        const Ellipsoid<Real> e = lifted<Real>(Ellipsoid<double>{centre, {r, r, r}});
        const Sphere<Real> sphere{lifted<Real>(centre), Real(r)};
        const auto same = [](const Real& x, const Real& y) { return abs(Real(x - y)) <= ldexp(abs(x), -200); };
        REQUIRE(same(e.off_surface(ray.origin), sphere.off_surface(ray.origin)));
        REQUIRE(same(e.distance(ray.origin), sphere.distance(ray.origin)));
        const Vec<Real> n = e.outward_normal(ray, ray.origin), m = sphere.outward_normal(ray, ray.origin);
        const Vec<Real> on = e.projected(ray, ray.origin), there = sphere.projected(ray, ray.origin);
        for (int k = 0; k < 3; ++k) REQUIRE((same(n[k], m[k]) && same(on[k], there[k])));
    }
}

/// Sampled on the surface: where some point is nearer than `distance` says, the bound is none.
TEST_CASE("no point of the surface is nearer than the field of an ellipsoid says", "[ellipsoid]") {
    Seeded rng(0x7a4);
    double closest = HUGE_VAL;
    for (int i = 0; i < 300; ++i) {
        const Ellipsoid<double> e{rng.vec(-1, 1), rng.vec(0.05, 2)};
        const Vec<double> p = rng.vec(-3, 3);
        const double field = e.distance(p);
        for (int k = 0; k < 300; ++k) {
            const Vec<double> u = rng.vec(-1, 1), on = e.centre + (1 / length(u)) * (u * e.radii);
            const double there = length(Vec<double>(p - on));
            REQUIRE(std::fabs(field) <= there * (1 + 1e-12));
            closest = std::min(closest, there / std::fabs(field));
        }
        REQUIRE((field < 0) == e.may_hold(p));
    }
    CHECK(closest < 1.1);
}

TEST_CASE("the point of a ray put onto an ellipsoid lies within its bound", "[ellipsoid]") {
    Seeded rng(0x7a5);
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
        const Ellipsoid<float> e{lifted<float>(rng.vec(-1, 1)), lifted<float>(rng.vec(0.05, 2))};
        const Vec<double> u = rng.vec(-1, 1);
        const Vec<float> p =
            lifted<float>(Vec<double>(lifted<double>(Vec<double>(e.centre.x, e.centre.y, e.centre.z))) +
                          u * Vec<double>(e.radii.x, e.radii.y, e.radii.z));
        const Ray<float> ray{p, {1, 0, 0}};
        const BoundedPoint<float> b = e.bounded_point(ray, 0, p);
        const auto exact = [](const Vec<float>& v) { return Vec<Real>(Real(v.x), Real(v.y), Real(v.z)); };
        const Vec<Real> on =
            Ellipsoid<Real>{exact(e.centre), exact(e.radii)}.projected(Ray<Real>{exact(p), exact(p)}, exact(p));
        for (int k = 0; k < 3; ++k) {
            const auto off = static_cast<double>(abs(Real(on[k] - Real(b.p[k]))));
            largest = std::max(largest, off / static_cast<double>(b.delta[k]));
        }
    }
    CHECK(largest < 1);
    CHECK(largest > 0.1);
}

}  // namespace lostbits::test::test_ellipsoid
