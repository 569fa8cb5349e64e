#include "measure/truth/truth.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "intersect/process/floating_point.hpp"
#include "measure/truth/side.hpp"
#include "number/error.hpp"

namespace lostbits::measure::truth {

using intersect::Convention;
using intersect::Touching;

namespace {

/// Exponent k of the power of two that the bound of x > 0 straddles; empty if the binade of x is certain. (The bound is
/// below 2^-72, and hi + lo is at least 2^-53 below 2, so it never reaches the binade above.)
std::optional<std::int64_t> straddled_power(const Certified& x) {
    if (x.hi == 1 && x.lo < x.bound && x.lo >= -x.bound) return x.exponent;
    return std::nullopt;
}

Interval interval_at_power(std::int64_t exponent) {
    Interval power(1);
    // Multiplies by powers of two that double holds, until nothing of the exponent is left.
    while (exponent != 0) {
        const std::int64_t part = std::clamp<std::int64_t>(exponent, -1000, 1000);
        power *= Interval(std::ldexp(1.0, static_cast<int>(part)));
        exponent -= part;
    }
    return power;
}

/// x, narrowed to one side of the power of two that its bound straddles: below it, at it or above it.
Certified on_side(const Certified& x, int side) {
    if (side == 0) return {.hi = 1, .lo = 0, .bound = 0, .exponent = x.exponent};
    // The interval [lo − bound, 0] or [0, lo + bound], given by its middle. Below the power, the middle must stay
    // negative even where it underflows.
    const double end = side < 0 ? x.lo - x.bound : x.lo + x.bound;
    const double middle = side < 0 ? std::min(end / 2, -0x1p-1074) : end / 2;
    return {.hi = 1, .lo = middle, .bound = std::fabs(end) / 2 * (1 + 0x1p-50) + 0x1p-1074, .exponent = x.exponent};
}

/// Writes a miss or a tightly enclosed hit to `truth`. Returns false if this precision does not settle it.
/// `decide_binade(x, Length)` narrows a length x to one binade, which its ulp depends on; it returns false if this
/// precision does not decide the binade.
template <class E, class DecideBinade>
bool settle(const Enclosed<E>& enclosed, Convention convention, Truth& truth, const DecideBinade& decide_binade) {
    truth.on_surface = enclosed.on_surface;
    if (enclosed.hit.is_yes() && enclosed.touching) {
        truth.touches = true;
        if (convention.touching == Touching::miss) return true;
    }
    if (enclosed.hit.is_no()) {
        truth.decision = Truth::Decision::miss;
        return true;
    }
    if (!enclosed.hit.is_yes()) return false;
    auto t = certify(enclosed.t), distance = certify(enclosed.distance);
    if (!t || !distance) return false;
    if (!decide_binade(*t, Length::parameter) || !decide_binade(*distance, Length::distance)) return false;
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
bool is_proper_primitive(const Primitive<S>& primitive) {
    return std::ranges::all_of(primitive.shape_numbers(), is_finite<S>) && !broken_limit(primitive) &&
           (!primitive.placed || primitive.placed->is_proper());
}

/// Limit, convention and range by which the truth about one primitive is found.
struct Terms {
    TruthLimit limit;
    Convention convention;
    Range<double> range;

    Terms(TruthLimit truth_limit, Convention full_convention, Range<double> full_range)
        : limit(truth_limit), range(full_range) {
        if (full_convention.endless) range.tmax = HUGE_VAL;
        convention = convention_in(range, full_convention);
    }
};

template <class E>
Enclosed<E> enclose_by(const Ray<E>& ray, const Primitive<E>& primitive, const Terms& terms) {
    const auto range = range_over<E>(terms.range);
    return enclose<E>(ray, primitive, range ? &*range : nullptr, terms.convention);
}

template <class S>
Truth escalate(const Ray<S>& ray, const Primitive<S>& primitive, const Terms& terms) {
    Truth truth;
    for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= terms.limit.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        truth.bits = bits;
        const Ray<Interval> wide_ray = lift_ray<Interval>(ray);
        const Primitive<Interval> wide_primitive = lift_primitive<Interval>(primitive);
        const auto decide_binade = [&](Certified& x, Length length) {
            const auto power = straddled_power(x);
            if (!power) return true;
            const auto range = range_over<Interval>(terms.range);
            const auto side = side_of(wide_ray, wide_primitive, interval_at_power(*power), length,
                                      range ? &*range : nullptr, terms.convention);
            if (side) x = on_side(x, *side);
            return side.has_value();
        };
        if (settle(enclose_by(wide_ray, wide_primitive, terms), terms.convention, truth, decide_binade)) return truth;
    }
    truth.decision = Truth::Decision::unresolved;
    return truth;
}

template <class S>
Truth find_all(const Ray<S>& ray, std::span<const Primitive<S>> primitives, TruthLimit limit,
               const Convention& convention, const Range<double>& range) {
    intersect::process::require_standard("the truth of a ray");
    Truth best;
    if (!is_ray(ray)) return best;
    const Ray<Ball> ball_ray = lift_ray<Ball>(ray);
    for (std::size_t index = 0; index < primitives.size(); ++index) {
        const Primitive<S>& primitive = primitives[index];
        const Terms terms(limit, convention.of(primitive.shape), range);
        if (!terms.range.holds_any() || !is_proper_primitive(primitive)) continue;
        Truth truth;
        truth.bits = 106;
        const auto is_binade_known = [](const Certified& x, Length) { return !straddled_power(x); };
        if (!settle(enclose_by(ball_ray, lift_primitive<Ball>(primitive), terms), terms.convention, truth,
                    is_binade_known))
            truth = escalate(ray, primitive, terms);
        join(truth, static_cast<int>(index), best);
    }
    return best;
}

template <class S>
double round_exactly(const Truth& truth, const Ray<S>& ray, const Primitive<S>& primitive, const FloatFormat& format,
                     Length length, const Terms& terms) {
    const auto [lower, upper] = round_ends(length == Length::parameter ? truth.t : truth.distance, format);
    if (lower == upper) return lower;
    for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= TruthLimit{}.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        // The rounding boundary that the bound straddles: midway between the two, or half a last place above the
        // largest number.
        const Interval boundary = std::isinf(upper)
                                      ? Interval(lower) + Interval(std::ldexp(1.0, format.emax - format.precision))
                                      : (Interval(lower) + Interval(upper)) / Interval(2);
        const auto range = range_over<Interval>(terms.range);
        const auto side = side_of(lift_ray<Interval>(ray), lift_primitive<Interval>(primitive), boundary, length,
                                  range ? &*range : nullptr, terms.convention);
        if (!side) continue;
        if (*side != 0) return *side < 0 ? lower : upper;
        return ordinal(lower, format) % 2 == 0 ? lower : upper;
    }
    throw Error(Exit::internal, "no precision was enough to tell the side of a rounding boundary");
}

}  // namespace

void join(const Truth& truth, int i, Truth& best) {
    const bool touches = best.touches || truth.touches, on_surface = best.on_surface || truth.on_surface;
    const int bits = std::max(best.bits, truth.bits);
    if (truth.decision == Truth::Decision::unresolved || best.decision == Truth::Decision::unresolved) {
        best.decision = Truth::Decision::unresolved;
    } else if (truth.is_hit() && (!best.is_hit() || compare(truth.t, best.t) < 0)) {
        best = truth;
        best.object = i;
    } else if (truth.is_hit() && compare(truth.t, best.t) == 0) {
        best.t = nearer(best.t, truth.t);
        best.distance = nearer(best.distance, truth.distance);
    }
    best.bits = bits;
    best.touches = touches;
    best.on_surface = on_surface;
}

Truth find_truth(const Ray<double>& ray, std::span<const Primitive<double>> primitives, TruthLimit limit,
                 Convention convention, const Range<double>& range) {
    return find_all(ray, primitives, limit, convention, range);
}
Truth find_truth(const Ray<Real>& ray, std::span<const Primitive<Real>> primitives, TruthLimit limit,
                 Convention convention, const Range<double>& range) {
    return find_all(ray, primitives, limit, convention, range);
}

bool is_proper(const Ray<double>& ray) { return is_ray(ray); }
bool is_proper(const Ray<Real>& ray) { return is_ray(ray); }
bool is_proper(const Primitive<double>& primitive) { return is_proper_primitive(primitive); }
bool is_proper(const Primitive<Real>& primitive) { return is_proper_primitive(primitive); }

double round_truth(const Truth& truth, const Ray<double>& ray, const Primitive<double>& primitive,
                   const FloatFormat& format, Length length, const Convention& convention, const Range<double>& range) {
    return round_exactly(truth, ray, primitive, format, length, {{}, convention, range});
}
double round_truth(const Truth& truth, const Ray<Real>& ray, const Primitive<Real>& primitive,
                   const FloatFormat& format, Length length, const Convention& convention, const Range<double>& range) {
    return round_exactly(truth, ray, primitive, format, length, {{}, convention, range});
}

}  // namespace lostbits::measure::truth
