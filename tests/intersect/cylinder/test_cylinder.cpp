// The truth of cylinders against fractions, alone and in packs; every form when nothing is rounded; and what a
// cylinder says of itself.
#include <map>
#include <string>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/certified_root.hpp"
#include "intersect/cylinder/cylinder_rays.hpp"
#include "intersect/packs_and_alone.hpp"

namespace lostbits::test::test_cylinder {

using intersect::AtOrigin;
using intersect::Touching;
using intersect::cylinder::CylinderForms;
using measure::truth::find_truth;
using measure::truth::Truth;

namespace {

using test::lifted;  // beside that of the shape

template <class T>
Cylinder<T> lifted(const Cylinder<double>& c) {
    return {lifted<T>(c.base), lifted<T>(c.top), static_cast<T>(c.radius)};
}

}  // namespace

TEST_CASE("the truth of a cylinder is what fractions say", "[truth][cylinder]") {
    std::map<std::string, int> hits, touches, from_it, exact;
    for_each_cylinder(static_cast<int>(draws(1500)), [&](const CylinderRays& family, const CylinderSample& s) {
        INFO(family.name);
        CAPTURE(s.ray.origin.x, s.ray.origin.y, s.ray.origin.z, s.ray.direction.x, s.ray.direction.y,
                s.ray.direction.z);
        const CappedAnswer right = answer_of(s);
        const Truth closed = find_truth(s.ray, Solid<double>(s.cylinder));
        REQUIRE(closed.decision == (right.meets() ? Truth::Decision::hit : Truth::Decision::miss));
        hits[family.name] += right.meets(), exact[family.name] += closed.bits > 106;
        if (!right.meets()) return;
        const bool on_surface = right.holds(0) && !right.is_within(0);
        REQUIRE(closed.touches == !right.goes_through());
        REQUIRE(closed.on_surface == on_surface);
        touches[family.name] += closed.touches, from_it[family.name] += on_surface;
        REQUIRE(encloses_first(closed.t, right));
        const Truth open = find_truth(s.ray, Solid<double>(s.cylinder), {}, Touching::miss);
        REQUIRE(open.is_hit() == right.goes_through());
        if (!on_surface) return;
        // Whoever passes over its origin meets the other end, if it lies ahead.
        const Truth passed = find_truth(s.ray, Solid<double>(s.cylinder), {}, AtOrigin::miss);
        const Rational ahead = power_of_two(-60);
        if (right.goes_through()) REQUIRE(passed.is_hit() == right.is_within(ahead));
    });
    for (const CylinderRays& family : cylinder_rays) {
        INFO(family.name << ": hits " << hits[family.name] << ", touches " << touches[family.name] << ", from it "
                         << from_it[family.name] << ", by intervals " << exact[family.name]);
        CHECK(hits[family.name] > 20);
    }
    CHECK(touches["beside the axis"] > 20);
    CHECK(touches["tangent"] > 20);
    CHECK(touches["through a rim"] > 20);
    CHECK(touches["in a cap"] > 20);
    CHECK(from_it["from the surface"] > 50);
    CHECK(exact["random"] == 0);
}

TEST_CASE("packs say of cylinders what the truth of each ray says", "[truth][cylinder]") {
    std::vector<RayAndSolid> asked;
    for_each_cylinder(static_cast<int>(draws(1500)), [&](const CylinderRays&, const CylinderSample& s) {
        asked.push_back({s.ray, s.cylinder});
    });
    check_packs_against_each_alone(asked);
}

TEST_CASE("every cylinder form solves the problem when nothing is rounded", "[intersect][cylinder][formula]") {
    struct Tally {
        long asked = 0, hits = 0, wrong = 0;
        std::string first = "none";  ///< of the families, in which it is wrong
    };
    std::array<Tally, CylinderForms::size> tallies{};
    const Rational off = power_of_two(-150);
    for_each_cylinder(static_cast<int>(draws(1000)), [&](const CylinderRays& family, const CylinderSample& s) {
        const CappedAnswer right = answer_of(s);
        if (!right.is_clear()) return;
        std::size_t form = 0;
        CylinderForms::for_each([&]<class Form>() {
            Tally& tally = tallies[form++];
            if (Form::info.roots == intersect::Roots::near_only && right.is_within(0)) return;
            Ray<Real> ray{lifted<Real>(s.ray.origin), lifted<Real>(s.ray.direction)};
            const Real size = Form::info.direction == intersect::Direction::unit ? length(ray.direction) : Real(1);
            ray.direction = Vec<Real>(ray.direction.x / size, ray.direction.y / size, ray.direction.z / size);
            const Hit<Real> h = Form::intersect(ray, lifted<Real>(s.cylinder));
            const Rational t = h.hit ? rational_from(Real(h.t / size)) : Rational(0);
            const bool good = h.hit == right.meets() && (!h.hit || right.is_first(t, off * abs(t)));
            ++tally.asked, tally.hits += h.hit;
            if (!good && tally.wrong++ == 0) tally.first = family.name;
        });
    });
    std::size_t form = 0;
    CylinderForms::for_each([&]<class Form>() {
        const Tally& t = tallies[form++];
        INFO(Form::info.name << ": asked " << t.asked << ", hits " << t.hits << ", wrong first in " << t.first);
        CHECK(t.wrong == 0);
        CHECK(t.asked > 150);
        CHECK(t.hits > t.asked / 5);
        CHECK(t.hits < t.asked);
    });
}

TEST_CASE("a cylinder's distance, normal and nearest point belong together", "[cylinder]") {
    Seeded rng(0x7a7);
    const Real tolerance = ldexp(Real(1), -200);
    int inside = 0, rims = 0;
    for (int i = 0; i < 500; ++i) {
        const Cylinder<double> plain{rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)};
        const Cylinder<Real> c = lifted<Real>(plain);
        const Vec<double> q = rng.vec(-2, 2);
        const Vec<Real> p = lifted<Real>(q);
        const Ray<Real> ray{p, p};
        const Vec<Real> on = c.projected(ray, p);
        const Real d = c.distance(p);
        REQUIRE(abs(c.distance(on)) <= tolerance);
        REQUIRE(abs(c.off_surface(on)) * c.unit() <= tolerance);
        REQUIRE(abs(Real(abs(d) - length(Vec<Real>(p - on)))) <= tolerance);
        REQUIRE(abs(c.off_surface(p)) * c.unit() <= abs(d) + tolerance);
        const Vec<Real> n = c.outward_normal(ray, on);
        REQUIRE(abs(Real(length(n) - Real(1))) <= tolerance);
        REQUIRE(c.distance(on + ldexp(Real(1), -20) * n) > 0);
        const Vec<double> v = plain.top - plain.base, f = q - plain.base;
        const double along = lostbits::dot(v, f), v2 = square(v);
        const bool on_rim = (along < 0 || along > v2) && length(lostbits::cross(v, f)) > plain.radius * std::sqrt(v2);
        if (!on_rim) REQUIRE(c.distance(on - ldexp(Real(1), -20) * n) < 0);
        rims += on_rim;
        REQUIRE((d < 0) == plain.may_hold(q));
        inside += d < 0;
        const Vec<Real> u = lifted<Real>(Vec<double>(rng.unit(), 0.5, 0.5));
        REQUIRE(c.distance(c.point_at(u)) <= tolerance);
    }
    CHECK(inside > 5);
    CHECK(rims > 20);
    CHECK(rims < 400);
}

TEST_CASE("the point of a ray put onto a cylinder lies within its bound", "[cylinder]") {
    Seeded rng(0x7a8);
    double largest = 0;
    for (int i = 0; i < 4000; ++i) {
        const double scale = rng.magnitude(-6, 6), off = rng.magnitude(-6, 6);
        const Vec<double> place = off * rng.vec(-1, 1), v = scale * rng.vec(-1, 1), w = scale * rng.vec(-1, 1);
        const Cylinder<float> c = lifted<float>(Cylinder<double>{place, place + v, scale * rng.uniform(0.01, 1)});
        const Vec<float> p = lifted<float>(place + rng.unit() * v + w);
        const auto exact = [](const Vec<float>& x) { return Vec<Real>(Real(x.x), Real(x.y), Real(x.z)); };
        const Cylinder<Real> same{exact(c.base), exact(c.top), Real(c.radius)};
        if (c.base == c.top) continue;
        // Put back by what rounding moved it: a point near the surface, as hits are.
        const Vec<Real> on = same.projected(Ray<Real>{exact(p), exact(p)}, exact(p));
        const Vec<float> near(static_cast<float>(on.x), static_cast<float>(on.y), static_cast<float>(on.z));
        const BoundedPoint<float> b = c.bounded_point(Ray<float>{near, {1, 0, 0}}, 0, near);
        double beyond = 0, allowed = 0;
        for (int k = 0; k < 3; ++k) allowed += static_cast<double>(b.delta[k]) * static_cast<double>(b.delta[k]);
        beyond = static_cast<double>(abs(same.distance(exact(b.p))));
        largest = std::max(largest, beyond / std::sqrt(allowed));
    }
    CHECK(largest < 1);
    CHECK(largest > 0.01);
}

}  // namespace lostbits::test::test_cylinder
