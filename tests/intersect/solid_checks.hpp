// What holds of every shape: held against an answer in fractions, or against itself. An answer says whether the ray
// meets the solid (`meets`), clear of every equality (`is_clear`), and whether a t that is off by at most e may be the
// first point (`is_first`).
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/certified_root.hpp"
#include "intersect/sampled_rays.hpp"

namespace lostbits::test {

/// What the truth said of the rays of each family, each held against fractions: of a solid whose answer also says
/// whether the open one is met (`goes_through`), and whether a point is in the closed or the open one (`holds`,
/// `is_within`).
struct TruthTally {
    std::map<std::string_view, int> hits, touches, from_it, exact;

    template <template <class> class S, class Answer>
    void hold(std::string_view family, const Sample<S>& s, const Answer& right) {
        using intersect::AtOrigin, intersect::Touching;
        using measure::truth::find_truth, measure::truth::Truth;
        INFO(family);
        CAPTURE(s.ray.origin.x, s.ray.origin.y, s.ray.origin.z, s.ray.direction.x, s.ray.direction.y,
                s.ray.direction.z);
        const Solid<double> solid(s.solid);
        const Truth closed = find_truth(s.ray, solid);
        REQUIRE(closed.decision == (right.meets() ? Truth::Decision::hit : Truth::Decision::miss));
        hits[family] += right.meets(), exact[family] += closed.bits > 106;
        if (!right.meets()) return;
        const bool on_surface = right.holds(0) && !right.is_within(0);
        REQUIRE(closed.touches == !right.goes_through());
        REQUIRE(closed.on_surface == on_surface);
        touches[family] += closed.touches, from_it[family] += on_surface;
        REQUIRE(encloses_first(closed.t, right));
        REQUIRE(find_truth(s.ray, solid, {}, Touching::miss).is_hit() == right.goes_through());
        // Whoever passes over its origin meets the other end, if it lies ahead.
        if (on_surface && right.goes_through())
            REQUIRE(find_truth(s.ray, solid, {}, AtOrigin::miss).is_hit() == right.is_within(power_of_two(-60)));
    }
    template <template <class> class S, std::size_t n>
    void check_hits(const SampledRays<S> (&families)[n]) {
        for (const SampledRays<S>& family : families) {
            INFO(family.name << ": hits " << hits[family.name] << ", touches " << touches[family.name] << ", from it "
                             << from_it[family.name] << ", by intervals " << exact[family.name]);
            CHECK(hits[family.name] > 20);
        }
    }
};

/// The solid with its numbers in another arithmetic.
template <template <class> class S>
S<Real> in_real(const S<double>& plain) {
    return transformed(Solid<double>(plain), [](double x) { return Real(x); }).template as<S>();
}

/// Whether a form that computes without rounding answers each ray rightly: in `Real`, to 2^-150 or as close as is said.
template <class Forms>
class UnroundedForms {
public:
    explicit UnroundedForms(int closeness = -150) : off_(power_of_two(closeness)) {}

    template <template <class> class S, class Answer>
    void ask(std::string_view family, const Sample<S>& s, const Answer& right, bool from_inside) {
        if (!right.is_clear()) return;
        const S<Real> solid = in_real(s.solid);
        std::size_t form = 0;
        Forms::for_each([&]<class Form>() {
            Tally& tally = tallies_[form++];
            if (Form::info.roots == intersect::Roots::near_only && from_inside) return;
            Ray<Real> ray{lifted<Real>(s.ray.origin), lifted<Real>(s.ray.direction)};
            const Real size = Form::info.direction == intersect::Direction::unit ? length(ray.direction) : Real(1);
            ray.direction = Vec<Real>(ray.direction.x / size, ray.direction.y / size, ray.direction.z / size);
            const Hit<Real> h = Form::intersect(ray, solid);
            const Rational t = h.hit ? rational_from(Real(h.t / size)) : Rational(0);
            const bool good = h.hit == right.meets() && (!h.hit || right.is_first(t, off_ * abs(t)));
            ++tally.asked, tally.hits += h.hit;
            if (!good && tally.wrong++ == 0) tally.first = family;
        });
    }
    void check(long least) const {
        std::size_t form = 0;
        Forms::for_each([&]<class Form>() {
            const Tally& t = tallies_[form++];
            INFO(Form::info.name << ": asked " << t.asked << ", hits " << t.hits << ", wrong " << t.wrong
                                 << ", first in " << t.first);
            CHECK(t.wrong == 0);
            CHECK(t.asked > least);
            CHECK(t.hits > t.asked / 5);
            CHECK(t.hits < t.asked);
        });
    }

private:
    struct Tally {
        long asked = 0, hits = 0, wrong = 0;
        std::string first = "none";  ///< of the families, in which it is wrong
    };
    Rational off_;
    std::array<Tally, Forms::size> tallies_{};
};

/// Of all forms of a shape whose answer also says whether a ray begins inside (`is_within`).
template <class Forms, class ForEach>
void check_unrounded(const ForEach& for_each) {
    UnroundedForms<Forms> forms;
    for_each(static_cast<int>(draws(1000)), [&](const auto& family, const auto& s) {
        const auto right = answer_of(s);
        forms.ask(family.name, s, right, right.is_within(0));
    });
    forms.check(150);
}

/// The nearest point of the surface: on it, as far away as `distance` says, with a normal of length one.
template <template <class> class S>
void check_nearest_point(const S<double>& plain, const Vec<double>& q) {
    const Real tolerance = ldexp(Real(1), -200);
    const S<Real> s = in_real(plain);
    const Vec<Real> p = lifted<Real>(q);
    const Ray<Real> ray{p, p};
    const Vec<Real> on = s.projected(ray, p);
    const Real d = s.distance(p);
    REQUIRE(abs(s.off_surface(on)) * s.unit() <= tolerance);
    REQUIRE(abs(s.off_surface(p)) * s.unit() <= abs(d) + tolerance);
    const Vec<Real> n = s.outward_normal(ray, on);
    REQUIRE(abs(Real(length(n) - Real(1))) <= tolerance);
    REQUIRE(abs(s.distance(on + ldexp(Real(1), -20) * n)) > 0);
    REQUIRE((d <= 0) == plain.may_hold(q));
}

/// The same of a solid, whose `projected` is the nearest point, however far away: as far as `distance` says, and but
/// for rims with the inside behind it. Returns whether the point is inside.
template <template <class> class S>
bool check_nearest_of_solid(const S<double>& plain, const Vec<double>& q, bool on_rim) {
    const Real tolerance = ldexp(Real(1), -200);
    check_nearest_point(plain, q);
    const S<Real> s = in_real(plain);
    const Vec<Real> p = lifted<Real>(q), on = s.projected({p, p}, p), n = s.outward_normal({p, p}, on);
    const Real d = s.distance(p);
    REQUIRE(abs(s.distance(on)) <= tolerance);
    REQUIRE(abs(Real(abs(d) - length(Vec<Real>(p - on)))) <= tolerance);
    REQUIRE(s.distance(on + ldexp(Real(1), -20) * n) > 0);
    if (!on_rim) REQUIRE(s.distance(on - ldexp(Real(1), -20) * n) < 0);
    return d < 0;
}

/// A point put onto the surface in float lies within its bound; what is returned is how much of that it takes.
template <template <class> class S>
double share_of_bound(const S<double>& solid, const Vec<double>& at) {
    std::array<float, most_numbers> numbers;
    std::size_t k = 0;
    each_number(solid, [&](double x) { numbers[k++] = static_cast<float>(x); });
    const S<float> s = solid_from<S, float>([&](std::size_t i) { return numbers[i]; });
    const S<Real> same = solid_from<S, Real>([&](std::size_t i) { return Real(numbers[i]); });
    const auto exact = [](const Vec<float>& x) { return Vec<Real>(Real(x.x), Real(x.y), Real(x.z)); };
    // Put back by what rounding moved it: a point near the surface, as hits are.
    const Vec<Real> p = lifted<Real>(at), on = same.projected(Ray<Real>{p, p}, p);
    const Vec<float> near(static_cast<float>(on.x), static_cast<float>(on.y), static_cast<float>(on.z));
    const BoundedPoint<float> b = s.bounded_point(Ray<float>{near, {1, 0, 0}}, 0, near);
    double allowed = 0;
    for (int i = 0; i < 3; ++i) allowed += static_cast<double>(b.delta[i]) * static_cast<double>(b.delta[i]);
    return static_cast<double>(abs(same.distance(exact(b.p)))) / std::sqrt(allowed);
}

/// The largest of so many solids of all sizes, near the origin and far: `make(from, to, size)` draws one along an axis.
template <class Make>
double largest_share_of_bound(Seeded& rng, int count, const Make& make) {
    double largest = 0;
    for (int i = 0; i < count; ++i) {
        const double scale = rng.magnitude(-6, 6), off = rng.magnitude(-6, 6);
        const Vec<double> from = off * rng.vec(-1, 1), v = scale * rng.vec(-1, 1), w = scale * rng.vec(-1, 1);
        const Vec<double> to = from + v;
        const auto solid = make(from, to, scale);
        const Vec<double> at = from + rng.unit() * v + w;
        if (testing::stored(from, binary32) == testing::stored(to, binary32)) continue;
        largest = std::max(largest, share_of_bound(solid, at));
    }
    return largest;
}

}  // namespace lostbits::test
