// The truth of discs and planes against fractions, alone and in packs; every form when nothing is rounded; and what
// these shapes say of themselves.
#include <map>
#include <string>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/packs_and_alone.hpp"
#include "intersect/sampled_rays.hpp"
#include "intersect/solid_checks.hpp"
#include "shapes/disc/disc.hpp"
#include "shapes/plane/plane.hpp"

namespace lostbits::test::test_disc {

using intersect::AtOrigin;
using intersect::Touching;
using measure::truth::find_truth;
using measure::truth::Truth;

namespace {

/// The plane by its equation, the point on it, and how far from the centre that is.
struct FlatAnswer {
    bool crosses = false;
    Rational t, distance2, outer2, inner2;

    [[nodiscard]] bool is_round() const { return outer2 > 0; }
    [[nodiscard]] bool meets() const {
        return crosses && t >= 0 && (!is_round() || (distance2 <= outer2 && distance2 >= inner2));
    }
    [[nodiscard]] bool on_rim() const {
        return is_round() && (distance2 == outer2 || (inner2 > 0 && distance2 == inner2));
    }
    [[nodiscard]] bool is_first(const Rational& x, const Rational& e) const { return abs(Rational(x - t)) <= e; }
    [[nodiscard]] bool is_clear() const {
        const auto apart = [](const Rational& a, const Rational& b) { return abs(Rational(a - b)) * (1 << 20) > b; };
        return crosses && t != 0 && (!is_round() || (apart(distance2, outer2) && apart(distance2, inner2)));
    }
};

FlatAnswer flat_answer(const Ray<double>& ray, const Vec<double>& at, const Vec<double>& normal, double outer,
                       double inner) {
    Rational from = 0, along = 0;
    for (int i = 0; i < 3; ++i) {
        from += (Rational(at[i]) - Rational(ray.origin[i])) * Rational(normal[i]);
        along += Rational(ray.direction[i]) * Rational(normal[i]);
    }
    FlatAnswer answer{along != 0, 0, 0, Rational(outer) * Rational(outer), Rational(inner) * Rational(inner)};
    if (!answer.crosses) return answer;
    answer.t = from / along;
    for (int i = 0; i < 3; ++i) {
        const Rational p = Rational(ray.origin[i]) + answer.t * Rational(ray.direction[i]) - Rational(at[i]);
        answer.distance2 += p * p;
    }
    return answer;
}

/// In the plane z = a whole number, of whole radii that 3, 4 and 5 divide.
Sample<Disc> level_disc(Seeded& rng) {
    const auto whole = [&](int low, int high) { return static_cast<double>(rng.integer(low, high)); };
    const double inner = 5 * whole(0, 9);
    return {{{}, {}},
            {{whole(-50, 50), whole(-50, 50), whole(-50, 50)}, {0, 0, whole(1, 9)}, inner + 5 * whole(1, 9), inner}};
}

const SampledRays<Disc> disc_rays[] = {
    {"random",
     [](Seeded& rng) {
         Sample<Disc> s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.3, 1), 0}};
         if (rng.coin()) s.solid.inner_radius = rng.unit() * s.solid.outer_radius;
         const Vec<double> aside = rng.vec(-0.7, 0.7);
         s.ray.direction = s.solid.centre + aside - s.ray.origin;
         return s;
     }},
    {"through a rim",
     [](Seeded& rng) {
         Sample<Disc> s = level_disc(rng);
         const double r = rng.coin() ? s.solid.outer_radius : s.solid.inner_radius;
         for (int i = 0; i < 3; ++i) s.ray.direction[i] = static_cast<double>(rng.integer(-9, 9));
         s.ray.origin = s.solid.centre + Vec<double>(0.6 * rng.sign() * r, 0.8 * rng.sign() * r, 0) -
                        static_cast<double>(rng.integer(-2, 30)) * s.ray.direction;
         return s;
     }},
    {"in its plane",
     [](Seeded& rng) {
         Sample<Disc> s = level_disc(rng);
         s.ray = {s.solid.centre - Vec<double>(static_cast<double>(rng.integer(-99, 99)), 200, 0), {0, 1, 0}};
         return s;
     }},
    {"nearly in its plane",
     [](Seeded& rng) {
         Sample<Disc> s{{{}, {}}, {rng.vec(-1, 1), rng.vec(-1, 1), 1, 0}};
         const AcrossAxis<double> across(s.solid.normal);
         const Vec<double> off = 0x1p-18 * rng.vec(-1, 1);
         s.ray.direction = across.side + off;
         const Vec<double> at = s.solid.centre + rng.uniform(-1.2, 1.2) * across.other;
         s.ray.origin = at - rng.uniform(-2, 8) * s.ray.direction;
         return s;
     }},
    {"from the surface",
     [](Seeded& rng) {
         Sample<Disc> s = level_disc(rng);
         s.solid.inner_radius = rng.coin() ? 0 : s.solid.inner_radius;
         s.ray = {s.solid.centre + Vec<double>(0.6 * s.solid.outer_radius, 0, 0), rng.vec(-1, 1)};
         return s;
     }},
    {"far away",
     [](Seeded& rng) {
         Sample<Disc> s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.3, 1), 0}};
         const Vec<double> aside = rng.vec(-0.7, 0.7);
         s.ray.origin = s.solid.centre + aside - 0x1p20 * s.ray.direction;
         return s;
     }},
    {"tiny", [](Seeded& rng) { return scaled_from_below(level_disc(rng), 0x1p-140); }},
    {"huge", [](Seeded& rng) { return scaled_from_below(level_disc(rng), 0x1p110); }},
};

const ForEachSample for_each_disc{disc_rays, 0xd15c};

FlatAnswer answer_of(const Sample<Disc>& s) {
    return flat_answer(s.ray, s.solid.centre, s.solid.normal, s.solid.outer_radius, s.solid.inner_radius);
}
Plane<double> plane_of(const Disc<double>& d) { return {d.centre, d.normal}; }
FlatAnswer answer_of_plane(const Sample<Disc>& s) { return flat_answer(s.ray, s.solid.centre, s.solid.normal, 0, 0); }

void check_truth(const Ray<double>& ray, const Solid<double>& solid, const FlatAnswer& right) {
    const Truth closed = find_truth(ray, solid);
    REQUIRE(closed.decision == (right.meets() ? Truth::Decision::hit : Truth::Decision::miss));
    REQUIRE(find_truth(ray, solid, {}, Touching::miss).is_hit() == (right.meets() && !right.on_rim()));
    if (!right.meets()) return;
    REQUIRE(closed.touches == right.on_rim());
    REQUIRE(closed.on_surface == (right.t == 0));
    REQUIRE(encloses_first(closed.t, right));
    REQUIRE(find_truth(ray, solid, {}, AtOrigin::miss).is_hit() == (right.t != 0));
}

}  // namespace

TEST_CASE("the truth of a disc and of its plane is what fractions say", "[truth][disc]") {
    std::map<std::string, int> hits, rims, from_it;
    for_each_disc(static_cast<int>(draws(1500)), [&](const SampledRays<Disc>& family, const Sample<Disc>& s) {
        INFO(family.name);
        CAPTURE(s.ray.origin.x, s.ray.origin.y, s.ray.origin.z, s.ray.direction.x, s.ray.direction.y,
                s.ray.direction.z);
        const FlatAnswer right = answer_of(s);
        check_truth(s.ray, s.solid, right);
        check_truth(s.ray, plane_of(s.solid), answer_of_plane(s));
        hits[family.name] += right.meets(), rims[family.name] += right.meets() && right.on_rim();
        from_it[family.name] += right.meets() && right.t == 0;
    });
    for (const SampledRays<Disc>& family : disc_rays) {
        INFO(family.name << ": hits " << hits[family.name] << ", rims " << rims[family.name]);
        CHECK((hits[family.name] > 20) == (std::string_view(family.name) != "in its plane"));
    }
    CHECK(rims["through a rim"] > 60);
    CHECK(from_it["from the surface"] > 50);
}

TEST_CASE("packs say of discs and planes what the truth of each ray says", "[truth][disc]") {
    check_packs_of(for_each_disc);
    check_packs_of(for_each_disc, plane_of);
}

TEST_CASE("every disc and plane form solves the problem when nothing is rounded", "[intersect][disc][formula]") {
    UnroundedForms<intersect::disc::DiscForms> discs;
    UnroundedForms<intersect::plane::PlaneForms> planes;
    for_each_disc(static_cast<int>(draws(1000)), [&](const SampledRays<Disc>& family, const Sample<Disc>& s) {
        discs.ask(family.name, s, answer_of(s), false);
        // A form may take what is nearly in the plane for parallel, or near the origin for there: by 2^-23, it says.
        const FlatAnswer plane = answer_of_plane(s);
        if (plane.t * plane.t * square(Vec<double>(s.ray.direction)) > 1 && std::string_view(family.name) == "random")
            planes.ask(family.name, Sample<Plane>{s.ray, plane_of(s.solid)}, plane, false);
    });
    discs.check(150);
    planes.check(60);
}

TEST_CASE("the distance, normal and nearest point of a disc and a plane belong together", "[disc]") {
    Seeded rng(0xd0d);
    double of_discs = 0, of_planes = 0;
    for (int i = 0; i < 500; ++i) {
        const double outer = rng.uniform(0.1, 1);
        const Disc<double> disc{rng.vec(-1, 1), rng.vec(-1, 1), outer, rng.coin() ? 0 : rng.unit() * outer};
        const Vec<double> q = rng.vec(-2, 2);
        check_nearest_point(disc, q);
        check_nearest_point(plane_of(disc), q);
        const Disc<Real> exact = in_real(disc);
        const Vec<Real> on = exact.point_at(lifted<Real>(Vec<double>(rng.unit(), rng.unit(), rng.unit())));
        REQUIRE(exact.distance(on) <= ldexp(Real(1), -180));
        REQUIRE(exact.distance(lifted<Real>(q)) <= length(Vec<Real>(lifted<Real>(q) - on)));
    }
    for (int i = 0; i < 2000; ++i) {
        const double scale = rng.magnitude(-6, 6), off = rng.magnitude(-6, 6);
        const Vec<double> place = off * rng.vec(-1, 1), w = scale * rng.vec(-0.5, 0.5);
        const Disc<double> disc{place, rng.vec(-1, 1), scale, 0};
        of_discs = std::max(of_discs, share_of_bound(disc, place + w));
        of_planes = std::max(of_planes, share_of_bound(plane_of(disc), place + w));
    }
    for (const double share : {of_discs, of_planes}) {
        CHECK(share < 1);
        CHECK(share > 0.01);
    }
}

}  // namespace lostbits::test::test_disc
