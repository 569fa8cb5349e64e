#include "measure/truth/truth.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "intersect/process/floating_point.hpp"
#include "measure/truth/compare_hit.hpp"
#include "number/error.hpp"

namespace lostbits::measure::truth {

using intersect::Convention;
using intersect::Touching;

namespace {

/// Exponent k of the power of two that the bound of x > 0 straddles; empty if the binade of x is certain. (The bound is
/// below 2^-72, and hi + lo is at least 2^-53 below 2, so it never reaches the binade above.)
std::optional<std::int64_t> straddled_power(const CertifiedNumber& x) {
    if (x.hi == 1 && x.lo < x.bound && x.lo >= -x.bound) return x.exponent;
    return std::nullopt;
}

/// The number 2^exponent, also beyond the range of double.
Interval power_of_two_interval(std::int64_t exponent) {
    Interval power(1);
    // Multiplies by powers of two that a double can hold.
    while (exponent != 0) {
        const std::int64_t part = std::clamp<std::int64_t>(exponent, -1000, 1000);
        power *= Interval(std::ldexp(1.0, static_cast<int>(part)));
        exponent -= part;
    }
    return power;
}

/// x, narrowed to one side of the power of two that its bound straddles: below it, at it or above it.
CertifiedNumber narrow_to_side(const CertifiedNumber& x, int side) {
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
bool settle(const EnclosedHit<E>& enclosed, Convention convention, Truth& truth, const DecideBinade& decide_binade) {
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
bool is_valid_ray(const Ray<S>& ray) {
    bool all_finite = true, has_direction = false;
    for (int i = 0; i < 3; ++i) {
        all_finite = all_finite && is_finite(ray.origin[i]) && is_finite(ray.direction[i]);
        has_direction = has_direction || ray.direction[i] != 0;
    }
    return all_finite && has_direction;
}

template <class S>
bool is_valid_primitive(const Primitive<S>& primitive) {
    return std::ranges::all_of(primitive.shape_numbers(), is_finite<S>) && !broken_limit(primitive) &&
           (!primitive.transform || primitive.transform->is_proper());
}

/// Limit, convention and range by which the truth about one primitive is found.
struct ProofOptions {
    ProofLimit limit;
    Convention convention;
    Range<double> range;

    ProofOptions(ProofLimit truth_limit, Convention full_convention, Range<double> full_range)
        : limit(truth_limit), range(full_range) {
        if (full_convention.endless) range.tmax = HUGE_VAL;
        convention = convention_in(range, full_convention);
    }
};

template <class E>
EnclosedHit<E> enclose_under(const Ray<E>& ray, const Primitive<E>& primitive, const ProofOptions& options) {
    const auto range = range_over<E>(options.range);
    return enclose<E>(ray, primitive, range ? &*range : nullptr, options.convention);
}

/// Finds the truth about one primitive in MPFI, at precisions that double up to the limit.
template <class S>
Truth find_in_intervals(const Ray<S>& ray, const Primitive<S>& primitive, const ProofOptions& options) {
    Truth truth;
    for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= options.limit.max_bits; bits *= 2) {
        const Interval::Precision precision(bits);
        truth.proof_bits = bits;
        const Ray<Interval> wide_ray = lift_ray<Interval>(ray);
        const Primitive<Interval> wide_primitive = lift_primitive<Interval>(primitive);

        // Narrows a length to one side of a power of two that its bound straddles.
        const auto decide_binade = [&](CertifiedNumber& x, Length length) {
            const auto power = straddled_power(x);
            if (!power) return true;
            const auto range = range_over<Interval>(options.range);
            const auto order = compare_hit(wide_ray, wide_primitive, power_of_two_interval(*power), length,
                                           range ? &*range : nullptr, options.convention);
            if (order) x = narrow_to_side(x, *order);
            return order.has_value();
        };

        if (settle(enclose_under(wide_ray, wide_primitive, options), options.convention, truth, decide_binade))
            return truth;
    }
    truth.decision = Truth::Decision::unresolved;
    return truth;
}

template <class S>
Truth find_first_hit(const Ray<S>& ray, std::span<const Primitive<S>> primitives, ProofLimit limit,
                     const Convention& convention, const Range<double>& range) {
    intersect::process::require_standard("the truth of a ray");
    Truth best;
    if (!is_valid_ray(ray)) return best;
    const Ray<Ball> ball_ray = lift_ray<Ball>(ray);
    for (std::size_t index = 0; index < primitives.size(); ++index) {
        const Primitive<S>& primitive = primitives[index];
        const ProofOptions options(limit, convention.for_shape(primitive.shape), range);
        if (!options.range.holds_any() || !is_valid_primitive(primitive)) continue;
        Truth truth;
        truth.proof_bits = 106;
        const auto is_binade_known = [](const CertifiedNumber& x, Length) { return !straddled_power(x); };
        if (!settle(enclose_under(ball_ray, lift_primitive<Ball>(primitive), options), options.convention, truth,
                    is_binade_known))
            truth = find_in_intervals(ray, primitive, options);
        merge_truth(truth, static_cast<int>(index), best);
    }
    return best;
}

template <class S>
double round_by_side(const Truth& truth, const Ray<S>& ray, const Primitive<S>& primitive, const FloatFormat& format,
                     Length length, const ProofOptions& options) {
    const auto [lower, upper] = round_ends(length == Length::parameter ? truth.t : truth.distance, format);
    if (lower == upper) return lower;
    for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= ProofLimit{}.max_bits; bits *= 2) {
        const Interval::Precision precision(bits);
        // The bound straddles this rounding boundary, midway between both ends or half an ulp above the largest finite
        // number.
        const Interval boundary = std::isinf(upper)
                                      ? Interval(lower) + Interval(std::ldexp(1.0, format.emax - format.precision))
                                      : (Interval(lower) + Interval(upper)) / Interval(2);
        const auto range = range_over<Interval>(options.range);
        const auto order = compare_hit(lift_ray<Interval>(ray), lift_primitive<Interval>(primitive), boundary, length,
                                       range ? &*range : nullptr, options.convention);
        if (!order) continue;
        if (*order != 0) return *order < 0 ? lower : upper;
        return ordinal(lower, format) % 2 == 0 ? lower : upper;
    }
    throw Error(ExitStatus::internal, "no precision was enough to tell the side of a rounding boundary");
}

}  // namespace

void merge_truth(const Truth& truth, int i, Truth& best) {
    const bool touches = best.touches || truth.touches, on_surface = best.on_surface || truth.on_surface;
    const int proof_bits = std::max(best.proof_bits, truth.proof_bits);
    if (truth.decision == Truth::Decision::unresolved || best.decision == Truth::Decision::unresolved) {
        best.decision = Truth::Decision::unresolved;
    } else if (truth.is_hit() && (!best.is_hit() || compare(truth.t, best.t) < 0)) {
        best = truth;
        best.primitive = i;
    } else if (truth.is_hit() && compare(truth.t, best.t) == 0) {
        best.t = nearer(best.t, truth.t);
        best.distance = nearer(best.distance, truth.distance);
    }
    best.proof_bits = proof_bits;
    best.touches = touches;
    best.on_surface = on_surface;
}

Truth find_truth(const Ray<double>& ray, std::span<const Primitive<double>> primitives, ProofLimit limit,
                 Convention convention, const Range<double>& range) {
    return find_first_hit(ray, primitives, limit, convention, range);
}
Truth find_truth(const Ray<Real>& ray, std::span<const Primitive<Real>> primitives, ProofLimit limit,
                 Convention convention, const Range<double>& range) {
    return find_first_hit(ray, primitives, limit, convention, range);
}

bool is_valid(const Ray<double>& ray) { return is_valid_ray(ray); }
bool is_valid(const Ray<Real>& ray) { return is_valid_ray(ray); }
bool is_valid(const Primitive<double>& primitive) { return is_valid_primitive(primitive); }
bool is_valid(const Primitive<Real>& primitive) { return is_valid_primitive(primitive); }

double round_truth(const Truth& truth, const Ray<double>& ray, const Primitive<double>& primitive,
                   const FloatFormat& format, Length length, const Convention& convention, const Range<double>& range) {
    return round_by_side(truth, ray, primitive, format, length, {{}, convention, range});
}
double round_truth(const Truth& truth, const Ray<Real>& ray, const Primitive<Real>& primitive,
                   const FloatFormat& format, Length length, const Convention& convention, const Range<double>& range) {
    return round_by_side(truth, ray, primitive, format, length, {{}, convention, range});
}

}  // namespace lostbits::measure::truth
