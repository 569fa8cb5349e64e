// The truth of tori against fractions, alone and in packs; every form when nothing is rounded; and what a torus says of
// itself.
#include <map>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/packs_and_alone.hpp"
#include "intersect/solid_checks.hpp"
#include "intersect/torus/torus_rays.hpp"
#include "measure/offset/half_line.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/reach.hpp"

namespace lostbits::test::test_torus {

using intersect::AtOrigin, intersect::Convention, intersect::Inside, intersect::Touching;
using measure::truth::find_truth, measure::truth::Truth;

namespace {

/// Whether the truth encloses the first root that is at least `from`; of those that are crossed, where that is asked.
bool is_first_root(const Truth& truth, const TorusAnswer& right, const Rational& from, bool crossed) {
    const auto& x = truth.t;
    const Rational unit = x.is_zero() ? Rational(1) : power_of_two(x.exponent);
    return right.is_first_from(from, (Rational(x.hi) + Rational(x.lo)) * unit, Rational(x.bound) * unit, crossed);
}

struct Tally {
    std::map<std::string_view, int> hits, touches, from_it, exact, four;
};

void hold(Tally& tally, std::string_view family, const Sample<Torus>& s, const TorusAnswer& right) {
    INFO(family);
    CAPTURE(s.ray.origin.x, s.ray.origin.y, s.ray.origin.z, s.ray.direction.x, s.ray.direction.y, s.ray.direction.z);
    CAPTURE(s.solid.centre.x, s.solid.centre.y, s.solid.centre.z, s.solid.axis.x, s.solid.axis.y, s.solid.axis.z);
    CAPTURE(s.solid.major_radius, s.solid.minor_radius);
    const Solid<double> solid(s.solid);
    const Truth closed = find_truth(s.ray, solid), open = find_truth(s.ray, solid, {}, Touching::miss);
    const auto* const first = right.first(0);
    REQUIRE(closed.decision == (first ? Truth::Decision::hit : Truth::Decision::miss));
    REQUIRE(open.decision == (right.goes_through() ? Truth::Decision::hit : Truth::Decision::miss));
    tally.hits[family] += first != nullptr, tally.exact[family] += closed.bits > 106;
    tally.four[family] += right.roots().size() == 4;
    if (!first) return;
    REQUIRE(is_first_root(closed, right, 0, false));
    REQUIRE(closed.touches == !first->crosses);
    REQUIRE(closed.on_surface == (right.at(0) == 0));
    if (open.is_hit()) REQUIRE(is_first_root(open, right, 0, true));
    tally.touches[family] += closed.touches, tally.from_it[family] += closed.on_surface;
    // From inside no exit counts where none is asked for, and what is passed over leaves the next root.
    Convention none;
    none.inside = Inside::miss;
    if (right.is_within(0)) REQUIRE_FALSE(find_truth(s.ray, solid, {}, none).is_hit());
    if (!closed.on_surface) return;
    const Rational little = power_of_two(-60);
    const Truth past = find_truth(s.ray, solid, {}, AtOrigin::miss);
    REQUIRE(past.is_hit() == (right.first(little) != nullptr));
    if (past.is_hit()) REQUIRE(is_first_root(past, right, little, false));
}

}  // namespace

TEST_CASE("the truth of a torus is what fractions say", "[truth][torus]") {
    Tally tally;
    for_each_torus(static_cast<int>(draws(1500)), [&](const SampledRays<Torus>& family, const Sample<Torus>& s) {
        hold(tally, family.name, s, answer_of(s));
    });
    for (const SampledRays<Torus>& family : torus_rays) {
        const auto name = family.name;
        INFO(name << ": hits " << tally.hits[name] << ", touches " << tally.touches[name] << ", from it "
                  << tally.from_it[name] << ", by intervals " << tally.exact[name] << ", four roots "
                  << tally.four[name]);
        CHECK(tally.hits[name] > 10);
    }
    for (const char* const touching : {"along its top", "at an equator", "through the middle, along both sides"}) {
        INFO(touching);
        CHECK(tally.touches[touching] > 10);
    }
    CHECK(tally.from_it["from the surface"] > 50);
    CHECK(tally.four["random"] > 5);
    CHECK(tally.exact["random"] == 0);
}

TEST_CASE("a range of a ray at a torus ends where fractions say", "[truth][torus]") {
    Seeded rng(0x7052);
    int before = 0, behind = 0, at_end = 0;
    for_each_torus(static_cast<int>(draws(300)), [&](const SampledRays<Torus>& family, const Sample<Torus>& s) {
        const ClearTorusAnswer right = answer_of(s);
        // Next to roots, or at them where they are doubles.
        std::vector<double> places{0, rng.uniform(0, 3)};
        for (const auto& root : right.roots()) places.push_back(right.near(root));
        const auto place = [&] {
            return std::fabs(places[static_cast<std::size_t>(rng.index(static_cast<int>(places.size())))]);
        };
        const double one = place(), other = place();
        if (!(std::min(one, other) < std::max(one, other))) return;
        const Range<double> range{std::min(one, other), std::max(one, other), {rng.coin(), rng.coin()}};
        const Rational begin(range.tmin), end(range.tmax);
        int inside = right.count(begin, end);
        inside -= range.open.tmin && right.at(begin) == 0 ? 1 : 0;
        inside -= range.open.tmax && right.at(end) == 0 ? 1 : 0;
        INFO(family.name << " from " << range.tmin << " to " << range.tmax);
        const Truth truth = find_truth(s.ray, Solid<double>(s.solid), {}, {}, range);
        REQUIRE(truth.decision == (inside > 0 ? Truth::Decision::hit : Truth::Decision::miss));
        (inside > 0 ? behind : before) += 1;
        at_end += right.at(end) == 0;
    });
    CHECK(before > 30);
    CHECK(behind > 30);
    CHECK(at_end > 10);
}

TEST_CASE("t of a torus is rounded as fractions say, on ties too", "[truth][torus]") {
    int asked = 0, ties = 0;
    for_each_torus(static_cast<int>(draws(300)), [&](const SampledRays<Torus>& family, const Sample<Torus>& s) {
        const Solid<double> solid(s.solid);
        const Truth truth = find_truth(s.ray, solid);
        if (!truth.is_hit()) return;
        const ClearTorusAnswer right = answer_of(s);
        INFO(family.name);
        for (const char* const name : {"f32", "bf16", "fp16"}) {
            const FloatFormat format = find_format(name)->shape;
            const double t = round_truth(truth, s.ray, solid, format);
            if (std::isinf(t) || t == 0) continue;
            ++asked;
            const double step = std::ldexp(1.0, std::max(std::ilogb(t), format.emin) - format.precision + 1);
            // Half a step to both sides; below a power of two the step is half as large, so that more is allowed.
            REQUIRE(right.is_first_from(0, Rational(t), Rational(step) / 2));
            ties += right.at(Rational(t) + Rational(step) / 2) == 0 || right.at(Rational(t) - Rational(step) / 2) == 0;
        }
    });
    CHECK(asked > 500);
    CHECK(ties > 0);
}

TEST_CASE("packs say of tori what the truth of each ray says", "[truth][torus]") { check_packs_of(for_each_torus); }

TEST_CASE("every torus form but one solves the problem when nothing is rounded", "[intersect][torus][formula]") {
    namespace torus = intersect::torus;
    // The resolvent of nearly biquadratic ones leaves half of the bits.
    UnroundedForms<
        intersect::FormList<torus::GraphicsGems, torus::PovRay, torus::BrlCad, torus::TorusDoubleInside,
                            torus::TorusFromClosest, torus::Bracketed, torus::BracketedInDouble, torus::FilteredTorus>>
        forms(-60);
    UnroundedForms<intersect::FormList<torus::Bracketed, torus::BracketedInDouble, torus::FilteredTorus>> close;
    // Where two roots are one, complex ones too, the last remainder is 0, and rounded in any precision it has a sign.
    UnroundedForms<intersect::FormList<torus::SturmTorus>> by_remainders;
    for_each_torus(static_cast<int>(draws(300)), [&](const SampledRays<Torus>& family, const Sample<Torus>& s) {
        const ClearTorusAnswer right = answer_of(s);
        forms.ask(family.name, s, right, right.is_within(0));
        close.ask(family.name, s, right, right.is_within(0));
        if (right.is_square_free()) by_remainders.ask(family.name, s, right, right.is_within(0));
    });
    forms.check(150);
    close.check(150);
    by_remainders.check(150);
}

TEST_CASE("a chain of remainders sees a torus where there is none, however wide its numbers", "[intersect][torus]") {
    // In the plane of its top, further from the axis than the top: the quartic is a square without real roots.
    const Ray<double> ray{{-1087, 9, -450}, {-3, -4, 0}};
    const Torus<double> torus{{0, 0, 0}, {0, 0, 1}, 875, 450};
    const TorusAnswer right(ray, torus);
    REQUIRE_FALSE(right.is_square_free());
    REQUIRE_FALSE(right.meets());
    Ray<Real> wide{lifted<Real>(ray.origin), lifted<Real>(ray.direction)};
    wide.direction = wide.direction / length(wide.direction);
    CHECK(intersect::torus::SturmTorus::intersect(wide, in_real(torus)).hit);
    CHECK_FALSE(intersect::torus::FilteredTorus::intersect(wide, in_real(torus)).hit);
}

TEST_CASE("an absolute threshold makes Quilez's torus wrong without any rounding", "[intersect][torus][formula]") {
    // Through the hole of a torus that has hardly one: where |d1| < 1e-4 its root is taken to be 0.
    int asked = 0, off = 0;
    double most = 0;
    for_each_torus(static_cast<int>(draws(1500)), [&](const SampledRays<Torus>& family, const Sample<Torus>& s) {
        const ClearTorusAnswer right = answer_of(s);
        if (family.name != std::string_view("through the hole") || !right.is_clear() || !right.meets()) return;
        const Vec<Real> d = lifted<Real>(s.ray.direction);
        const Real size = length(d);
        const Hit<Real> h = intersect::torus::QuilezTorus::intersect<Real>(
            {lifted<Real>(s.ray.origin), Vec<Real>(d.x / size, d.y / size, d.z / size)}, in_real(s.solid));
        ++asked;
        if (!h.hit) return;
        const double t = right.near(*right.first(0)), told = Real(h.t / size).convert_to<double>();
        off += std::fabs(told - t) > 1e-6 * t;
        most = std::max(most, std::fabs(told - t) / t);
    });
    CHECK(asked > 50);
    CHECK(off > 3);
    CHECK(most > 0.001);
    CHECK(most < 0.1);
}

TEST_CASE("a torus's distance, normal and nearest point belong together", "[torus]") {
    Seeded rng(0x705);
    int inside = 0;
    double share = 0;
    for (int i = 0; i < 500; ++i) {
        const Torus<double> torus{rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(1, 2), rng.uniform(0.1, 0.99)};
        const Vec<double> q = rng.vec(-2, 2);
        inside += check_nearest_of_solid(torus, q, false);
        // A distance is the least to a point of the surface: none of these is nearer.
        const Torus<Real> exact = in_real(torus);
        const Real d = abs(exact.distance(lifted<Real>(q)));
        for (int k = 0; k < 20; ++k) {
            const Vec<Real> other = exact.projected({}, lifted<Real>(rng.vec(-2, 2)));
            REQUIRE(length(Vec<Real>(lifted<Real>(q) - other)) >= d * (1 - ldexp(Real(1), -180)));
        }
    }
    for (int i = 0; i < 2000; ++i) {
        const double scale = rng.magnitude(-6, 6), off = rng.magnitude(-6, 6);
        const Vec<double> place = off * rng.vec(-1, 1), axis = rng.vec(-1, 1), w = scale * rng.vec(-1, 1);
        const Torus<double> torus{place, axis, scale, scale * rng.uniform(0.01, 0.99)};
        share = std::max(share, share_of_bound(torus, place + w));
    }
    CHECK(inside > 5);
    CHECK(share < 1);
    CHECK(share > 0.01);
}

TEST_CASE("what half an ulp of each number moves t of a torus by is within its reach", "[truth][torus]") {
    Seeded rng(0x706);
    int asked = 0, wide = 0;
    double share = 0;
    for_each_torus(static_cast<int>(draws(300)), [&](const SampledRays<Torus>& family, const Sample<Torus>& s) {
        const Solid<double> solid(s.solid);
        const Truth truth = find_truth(s.ray, solid);
        if (!truth.is_hit() || truth.touches || truth.on_surface) return;
        const double reach = measure::truth::reach(s.ray, solid, truth.t, binary32);
        const std::size_t roots = answer_of(s).roots().size();
        INFO(family.name);
        for (int k = 0; k < 4; ++k) {
            const auto moved = [&](double x) {
                const double ulp = x == 0 ? 0 : std::ldexp(1.0, std::max(std::ilogb(x), -126) - 24);
                return x + rng.uniform(-1, 1) * ulp;
            };
            const auto moved_point = [&](const Vec<double>& v) {
                const double x = moved(v.x), y = moved(v.y), z = moved(v.z);
                return Vec<double>(x, y, z);
            };
            const Vec<double> o = moved_point(s.ray.origin), d = moved_point(s.ray.direction);
            const Ray<double> ray{o, d};
            const Solid<double> other = transformed(solid, moved);
            // Another root is another answer.
            if (TorusAnswer(ray, other.torus()).roots().size() != roots) continue;
            const Truth there = find_truth(ray, other);
            if (!there.is_hit()) continue;
            const double apart = std::fabs(scaled_difference(there.t, truth.t, truth.t.exponent));
            const double allowed = std::ldexp(reach, -static_cast<int>(truth.t.exponent));
            REQUIRE(apart <= allowed);
            ++asked;
            wide += std::isinf(allowed) ? 1 : 0;
            if (family.name == std::string_view("random")) share = std::max(share, apart / allowed);
        }
    });
    CHECK(asked > 500);
    CHECK(wide == 0);
    CHECK(share > 0.1);
}

TEST_CASE("how strongly errors act on t of a torus is what its derivatives say", "[truth][torus]") {
    // t = 5 − (R + r) = 2, with derivatives −1 by o.x, −t by d.x, −1 by R and by r; turning the axis moves nothing.
    const Ray<double> ray{{-5, 0, 0}, {1, 0, 0}};
    CHECK(measure::truth::condition(ray, Solid<double>(Torus<double>{{0, 0, 0}, {0, 0, 1}, 2, 1})) == Approx(5));
    // A line along the top touches: no derivative exists.
    CHECK(measure::truth::condition({{-5, 0, 1}, {1, 0, 0}},
                                    Solid<double>(Torus<double>{{0, 0, 0}, {0, 0, 1}, 2, 1})) == HUGE_VAL);
}

TEST_CASE("half-lines and ways meet a torus where they are in it, and not in its hole", "[torus]") {
    using measure::offset::find_meeting, measure::offset::Meeting, measure::offset::passes_through;
    const Solid<double> torus(Torus<double>{{0, 0, 0}, {0, 0, 3}, 2, 1});
    const auto from = [&](const Vec<double>& o, const Vec<double>& d) { return find_meeting({{o, d}, 0}, torus); };
    CHECK(from({0, 0, 0}, {1, 0, 0}) == Meeting{.inside = false, .outside = true, .meets = true});
    CHECK(from({0, 0, 0}, {0, 0, 1}) == Meeting{.inside = false, .outside = true, .meets = false});
    CHECK(from({2, 0, 0}, {1, 0, 0}) == Meeting{.inside = true, .outside = false, .meets = true});
    CHECK(from({1, 0, 0}, {1, 0, 0}) == Meeting{.inside = false, .outside = false, .meets = true});
    CHECK(from({1, 0, 0}, {-1, 0, 0}) == Meeting{.inside = false, .outside = false, .meets = true});
    CHECK(from({1, 0, 0}, {0, 0, 1}) == Meeting{.inside = false, .outside = false, .meets = false});
    CHECK(from({3, 0, 0}, {1, 0, 0}) == Meeting{.inside = false, .outside = false, .meets = false});
    CHECK(from({-9, 0, 1}, {1, 0, 0}) == Meeting{.inside = false, .outside = true, .meets = false});
    CHECK(from({-9, 1, 0}, {1, 0, 0}) == Meeting{.inside = false, .outside = true, .meets = true});
    CHECK_FALSE(passes_through({0, 0, -5}, {0, 0, 5}, torus));
    CHECK_FALSE(passes_through({-0.9, 0, 0}, {0.9, 0, 0}, torus));
    CHECK(passes_through({0, 0, 0}, {1.5, 0, 0}, torus));
    CHECK(passes_through({-5, 0, 0}, {5, 0, 0}, torus));
    CHECK(passes_through({2, 0, 0}, {2.5, 0, 0}, torus));
    CHECK_FALSE(passes_through({-5, 0, 1}, {5, 0, 1}, torus));
}

}  // namespace lostbits::test::test_torus
