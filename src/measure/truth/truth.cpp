#include "measure/truth/truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

#include "measure/truth/enclose_solid.hpp"
#include "number/error.hpp"

namespace lostbits::measure::truth {

using intersect::Touching;

namespace {

/// Fills in a miss or a tightly enclosed hit; false where this precision does not settle it.
template <class E>
bool settle(const Enclosed<E>& e, Touching touching, Truth& truth) {
    if (e.hit.is_yes() && e.touching) {
        truth.touches = true;
        if (touching == Touching::miss) return true;
    }
    if (e.hit.is_no()) {
        truth.decision = Truth::Decision::miss;
        return true;
    }
    if (!e.hit.is_yes()) return false;
    const auto t = certify(e.t);
    if (!t) return false;
    const auto distance = certify(e.distance);
    if (!distance) return false;
    truth.decision = Truth::Decision::hit;
    truth.t = *t;
    truth.distance = *distance;
    return true;
}

template <class S>
bool is_finite(const S& x) {
    using std::isfinite;
    return isfinite(x);
}

template <class S>
bool is_ray(const Ray<S>& r) {
    bool finite = true, moves = false;
    for (int i = 0; i < 3; ++i) {
        finite = finite && is_finite(r.origin[i]) && is_finite(r.direction[i]);
        moves = moves || r.direction[i] != 0;
    }
    return finite && moves;
}

template <class S>
bool is_solid(const Solid<S>& s) {
    if (!std::ranges::all_of(s.used(), is_finite<S>)) return false;
    if (s.shape == Shape::sphere) return s.sphere().radius > 0;
    const Box<S> box = s.box();
    return box.lo.x <= box.hi.x && box.lo.y <= box.hi.y && box.lo.z <= box.hi.z;
}

template <class E>
Enclosed<E> enclose_until(const Ray<E>& ray, const Solid<E>& solid, double tmax) {
    if (std::isinf(tmax)) return enclose<E>(ray, solid);
    const E end(tmax);
    return enclose<E>(ray, solid, &end);
}

template <class S>
Truth escalate(const Ray<S>& ray, const Solid<S>& solid, TruthLimit limit, Touching touching, double tmax) {
    Truth truth;
    for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= limit.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        truth.bits = bits;
        if (settle(enclose_until(lift_ray<Interval>(ray), lift_solid<Interval>(solid), tmax), touching, truth))
            return truth;
    }
    truth.decision = Truth::Decision::unresolved;
    return truth;
}

/// Takes the truth about solid `i` into what is known of the solids before it.
void join(const Truth& of_one, int i, Truth& best) {
    const bool touches = best.touches || of_one.touches;
    const int bits = std::max(best.bits, of_one.bits);
    if (of_one.decision == Truth::Decision::unresolved || best.decision == Truth::Decision::unresolved) {
        best.decision = Truth::Decision::unresolved;
    } else if (of_one.is_hit() && (!best.is_hit() || compare(of_one.t, best.t) < 0)) {
        best = of_one;
        best.object = i;
    } else if (of_one.is_hit() && compare(of_one.t, best.t) == 0) {
        best.t = nearer(best.t, of_one.t);
        best.distance = nearer(best.distance, of_one.distance);
    }
    best.bits = bits;
    best.touches = touches;
}

/// How the truth is asked for, whichever the solids.
struct Terms {
    TruthLimit limit;
    Touching touching;
    double tmax;
};

/// About the solids at the places `among`.
template <class S, class Places>
Truth find(const Ray<S>& ray, std::span<const Solid<S>> solids, const Places& among, const Terms& terms) {
    const auto [limit, touching, tmax] = terms;
    Truth best;
    if (!is_ray(ray) || !(tmax >= 0)) return best;
    const Ray<Ball> quick = lift_ray<Ball>(ray);
    for (const std::size_t at : among) {
        const Solid<S>& solid = solids[at];
        if (!is_solid(solid)) continue;
        Truth one;
        one.bits = 106;
        if (!settle(enclose_until(quick, lift_solid<Ball>(solid), tmax), touching, one))
            one = escalate(ray, solid, limit, touching, tmax);
        join(one, static_cast<int>(at), best);
    }
    return best;
}

template <class S>
Truth find_all(const Ray<S>& ray, std::span<const Solid<S>> solids, const Terms& terms) {
    return find(ray, solids, std::views::iota(std::size_t{0}, solids.size()), terms);
}

/// −1, 0, +1 as t* lies below, at or above the dyadic number m > 0, or nothing where this precision does not tell: with
/// P(t) = a t² + 2 h t + c, the near root (from outside) is above m where P(m) > 0 and a m + h < 0; the far root (from
/// inside) is above m where P(m) < 0. From outside P is positive before the near root, from inside negative before the
/// far one.
std::optional<int> side_of(const Ray<Interval>& ray, const Sphere<Interval>& sphere, const Interval& m) {
    const Interval zero(0);
    const Vec<Interval> f = ray.origin - sphere.centre;
    const Interval a = square(ray.direction);
    const Interval h = dot(f, ray.direction);
    const Interval c = square(f) - square(sphere.radius);
    const Interval p = (a * m + h + h) * m + c;
    const Interval past = a * m + h;
    if ((c > zero).is_unknown()) return std::nullopt;
    const bool outside = (c > zero).is_yes();
    if ((p < zero).is_yes()) return outside ? -1 : 1;
    if (!(p > zero).is_yes() && !p.is_exact()) return std::nullopt;
    if (!outside) return p.is_exact() && !(p > zero).is_yes() ? 0 : -1;
    // Past the middle both P(m) > 0 and the root P(m) = 0 lie beyond the near root.
    if ((past > zero).is_unknown()) return std::nullopt;
    if ((past > zero).is_yes()) return -1;
    return (p > zero).is_yes() ? 1 : 0;
}

template <class S>
double round_exactly(const Truth& truth, const Ray<S>& ray, const Solid<S>& solid, const FloatFormat& format) {
    const auto [lower, upper] = round_ends(truth.t, format);
    if (lower == upper) return lower;
    for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= TruthLimit{}.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        // The boundary that the bound straddles: midway between the two, or half a last place above the largest number.
        const Interval middle = std::isinf(upper)
                                    ? Interval(lower) + Interval(std::ldexp(1.0, format.emax - format.precision))
                                    : (Interval(lower) + Interval(upper)) / Interval(2);
        const auto lifted = lift_solid<Interval>(solid);
        const auto side = solid.shape == Shape::sphere ? side_of(lift_ray<Interval>(ray), lifted.sphere(), middle)
                                                       : truth::side_of(lift_ray<Interval>(ray), lifted.box(), middle);
        if (!side) continue;
        if (*side != 0) return *side < 0 ? lower : upper;
        return ordinal(lower, format) % 2 == 0 ? lower : upper;
    }
    throw Error(Exit::internal, "no precision was enough to tell the side of a rounding boundary");
}

}  // namespace

Truth find_truth(const Ray<double>& ray, std::span<const Solid<double>> solids, TruthLimit limit, Touching touching,
                 double tmax) {
    return find_all(ray, solids, {limit, touching, tmax});
}
Truth find_truth(const Ray<Real>& ray, std::span<const Solid<Real>> solids, TruthLimit limit, Touching touching,
                 double tmax) {
    return find_all(ray, solids, {limit, touching, tmax});
}

Truth find_truth_among(const Ray<double>& ray, std::span<const Solid<double>> solids,
                       std::span<const std::uint32_t> among, TruthLimit limit, Touching touching) {
    return find(ray, solids, among, {limit, touching, HUGE_VAL});
}
Truth find_truth_among(const Ray<Real>& ray, std::span<const Solid<Real>> solids, std::span<const std::uint32_t> among,
                       TruthLimit limit, Touching touching) {
    return find(ray, solids, among, {limit, touching, HUGE_VAL});
}

bool is_proper(const Ray<double>& ray) { return is_ray(ray); }
bool is_proper(const Ray<Real>& ray) { return is_ray(ray); }
bool is_proper(const Solid<double>& solid) { return is_solid(solid); }
bool is_proper(const Solid<Real>& solid) { return is_solid(solid); }

double round_truth(const Truth& truth, const Ray<double>& ray, const Solid<double>& solid, const FloatFormat& format) {
    return round_exactly(truth, ray, solid, format);
}
double round_truth(const Truth& truth, const Ray<Real>& ray, const Solid<Real>& solid, const FloatFormat& format) {
    return round_exactly(truth, ray, solid, format);
}

}  // namespace lostbits::measure::truth
