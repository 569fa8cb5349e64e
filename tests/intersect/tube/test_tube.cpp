// The truth of tubes against fractions, alone and in packs; every form when nothing is rounded; and what a tube says of
// itself. The rays are those at cylinders.
#include <map>
#include <optional>
#include <string>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/cylinder/cylinder_rays.hpp"
#include "intersect/packs_and_alone.hpp"
#include "intersect/solid_checks.hpp"
#include "shapes/tube/tube.hpp"

namespace lostbits::test::test_tube {

using intersect::AtOrigin;
using measure::truth::find_truth;
using measure::truth::Truth;

namespace {

/// Where P of the infinite cylinder is 0 between the ends: told by signs of P at the ends of an interval and where it
/// is least.
struct WallAnswer {
    CappedAnswer solid;

    [[nodiscard]] bool has_root(const Rational& from, const Rational& to) const {
        if (to < from || solid.a == 0) return false;
        const Rational x = solid.at(from), y = solid.at(to), least = -solid.h / solid.a;
        if (x == 0 || y == 0 || (x < 0) != (y < 0)) return true;
        return x > 0 && from < least && least < to && solid.at(least) <= 0;
    }
    /// Between the ends of the tube, of that part of the line; nothing where no t is.
    [[nodiscard]] bool meets(const Rational& from, const std::optional<Rational>& to = {}) const {
        if (!solid.between) return false;
        // Beyond both roots of a parabola nothing is 0: |t| ≤ 1 + max(|2h|, |c|)/a.
        const Rational far = solid.a == 0 ? Rational(0) : 1 + (2 * abs(solid.h) + abs(solid.c)) / solid.a;
        const Rational low = solid.low ? std::max(*solid.low, from) : from;
        Rational high = solid.high ? *solid.high : std::max(far, from);
        if (to) high = std::min(high, *to);
        return has_root(low, high);
    }
    [[nodiscard]] bool meets() const { return meets(0); }
    [[nodiscard]] bool is_first(const Rational& t, const Rational& e) const {
        const Rational before = t - e, few = Rational(e > 0 ? e : Rational(1)) * power_of_two(-40);
        return meets(std::max(Rational(0), before), Rational(t + e)) &&
               (before <= 0 || !meets(0, Rational(before - few)));
    }
    [[nodiscard]] bool is_clear() const {
        const Rational q = solid.h * solid.h - solid.a * solid.c;
        return solid.is_clear() && q * (1 << 20) > solid.h * solid.h;
    }
};

Tube<double> opened(const Cylinder<double>& c) { return {c.base, c.top, c.radius}; }

}  // namespace

TEST_CASE("the truth of a tube is what fractions say", "[truth][tube]") {
    std::map<std::string, int> hits, touches, from_it, through_an_end;
    for_each_cylinder(
        static_cast<int>(draws(1500)), [&](const SampledRays<Cylinder>& family, const Sample<Cylinder>& s) {
            INFO(family.name);
            CAPTURE(s.ray.origin.x, s.ray.origin.y, s.ray.origin.z, s.ray.direction.x, s.ray.direction.y,
                    s.ray.direction.z);
            const WallAnswer right{answer_of(s)};
            const Solid<double> tube(opened(s.solid));
            const Truth closed = find_truth(s.ray, tube);
            REQUIRE(closed.decision == (right.meets() ? Truth::Decision::hit : Truth::Decision::miss));
            hits[family.name] += right.meets(), through_an_end[family.name] += right.solid.meets() && !right.meets();
            if (!right.meets()) return;
            const bool on_surface = right.meets(0, Rational(0));
            REQUIRE(closed.on_surface == on_surface);
            touches[family.name] += closed.touches, from_it[family.name] += on_surface;
            REQUIRE(encloses_first(closed.t, right));
            if (!on_surface) return;
            // Whoever passes over its origin meets the other side, if it lies ahead. The way there is no shorter than
            // 2^-40: the rays are short numbers.
            const Truth passed = find_truth(s.ray, tube, {}, AtOrigin::miss);
            REQUIRE(passed.is_hit() == right.meets(power_of_two(-40)));
        });
    for (const char* const family : {"random", "tangent", "through a rim", "from inside", "thin", "far away"}) {
        INFO(family << ": hits " << hits[family] << ", touches " << touches[family]);
        CHECK(hits[family] > 20);
    }
    CHECK(touches["tangent"] > 20);
    CHECK(touches["through a rim"] > 20);
    CHECK(through_an_end["nearly beside the axis"] > 20);
    CHECK(hits["beside the axis"] == 0);
    CHECK(from_it["from the surface"] > 50);
}

TEST_CASE("packs say of tubes what the truth of each ray says", "[truth][tube]") {
    check_packs_of(for_each_cylinder, opened);
}

TEST_CASE("every tube form solves the problem when nothing is rounded", "[intersect][tube][formula]") {
    UnroundedForms<intersect::tube::TubeForms> forms;
    for_each_cylinder(static_cast<int>(draws(1000)),
                      [&](const SampledRays<Cylinder>& family, const Sample<Cylinder>& s) {
                          forms.ask(family.name, Sample<Tube>{s.ray, opened(s.solid)}, WallAnswer{answer_of(s)}, false);
                      });
    forms.check(150);
}

TEST_CASE("a tube's distance, normal and nearest point belong together", "[tube]") {
    Seeded rng(0x70b);
    for (int i = 0; i < 500; ++i) {
        const Tube<double> tube{rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)};
        const Vec<double> q = rng.vec(-2, 2);
        check_nearest_point(tube, q);
        const Tube<Real> exact = in_real(tube);
        const Vec<Real> u = lifted<Real>(Vec<double>(rng.unit(), rng.unit(), rng.unit()));
        REQUIRE(exact.distance(exact.point_at(u)) <= ldexp(Real(1), -180));
        REQUIRE(exact.distance(lifted<Real>(q)) <=
                length(Vec<Real>(lifted<Real>(q) - exact.point_at(u))) + ldexp(Real(1), -180));
    }
    const double share =
        largest_share_of_bound(rng, 2000, [&](const Vec<double>& from, const Vec<double>& to, double size) {
            return Tube<double>{from, to, size * rng.uniform(0.01, 1)};
        });
    CHECK(share < 1);
    CHECK(share > 0.01);
}

}  // namespace lostbits::test::test_tube
