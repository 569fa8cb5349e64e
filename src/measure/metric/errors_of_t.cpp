// Metrics of the error of t, and of the parts of it that the inputs, the formula and its rounding cause.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "measure/bits/log2.hpp"
#include "measure/metric/values.hpp"
#include "measure/stability/stability.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/lost_bits.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

/// (x − y) in ulps of the format at t*.
double in_ulps(const Sample& sample, const truth::CertifiedNumber& x, const truth::CertifiedNumber& y) {
    return truth::scaled_difference(x, y, ulp_exponent(sample.format->parameters, sample.true_t->floor_log2()));
}

double error_at_zero(const Sample& sample) {
    if (!sample.true_t->is_zero() || !sample.primitive) return missing;
    if (sample.t == 0) return 0;
    double largest = 0;
    const auto include = [&largest](double x) { largest = std::max(largest, std::fabs(x)); };
    for (int axis = 0; axis < 3; ++axis) include(sample.ray->origin[axis]);
    for_each_key(sample.primitive->shape, [&](const Key& key, std::size_t first) {
        for (std::size_t k = first; k < first + key.count(); ++k)
            if (key.kind != Key::Kind::direction && !sample.primitive->transform) include(sample.primitive->numbers[k]);
    });
    return in_roundoffs(distance_error(sample) / largest, sample);
}

double root(const Sample& sample) {
    if (sample.march) return missing;
    if (sample.outcome != answer::Outcome::agree_hit || !sample.primitive) return 0;
    const bool is_close = std::fabs(ulp_error(sample)) <= 8;  // the format cannot distinguish nearer crossings
    return !is_close && stability::is_wrong_root(*sample.ray, *sample.primitive, *sample.true_t, sample.t) ? 2 : 1;
}

double derivative_error(const Sample& sample) {
    if (!sample.attribution || sample.march || !sample.primitive || sample.primitive->transform) return missing;
    if (sample.attribution->attribution->subject != sample.attribution->tape->outputs.t) return missing;
    const std::vector<double> exact = truth::gradient(*sample.ray, *sample.primitive, sample.convention, sample.range);
    if (exact.empty()) return missing;

    // Each error is divided by the largest derivative of its vector.
    const std::vector<double> computed = stability::compute_forward_derivatives(*sample.attribution->tape);
    double worst = 0;
    const auto compare_vector = [&](std::size_t first, std::size_t count) {
        double largest = 0, error = 0;
        for (std::size_t k = first; k < first + count; ++k) {
            largest = std::max(largest, std::fabs(exact[k]));
            error = std::isnan(computed[k]) ? HUGE_VAL : std::max(error, std::fabs(computed[k] - exact[k]));
        }
        worst = std::max(worst, error == 0 ? 0 : error / largest);
    };

    // Derivatives are in the order of the inputs: origin, direction, numbers of the primitive.
    constexpr std::size_t origin = 0, direction = 3, primitive = 6;
    compare_vector(origin, 3);
    if (sample.direction != intersect::Direction::unit) compare_vector(direction, 3);
    for_each_key(sample.primitive->shape, [&](const Key& key, std::size_t first) {
        if (key.kind != Key::Kind::direction) compare_vector(primitive + first, key.count());
    });
    return in_roundoffs(worst, sample);
}

/// Categories, in the order of the values of `root`.
constexpr std::string_view root_names[] = {"no_hit", "true", "wrong"};

/// Metrics for cases in which an ulp of t* says nothing, or not enough.
constexpr Metric rows_of_t[] = {
    table_row(
        {"error_at_zero", "u", "err.at_zero"},
        "for a hit at t* = 0, where an error in ulps says nothing: |t| |d| / (u M), where M is the largest number of "
        "the origin and of the points and lengths of the primitive",
        error_at_zero, {.ramp = Ramp::magnitude, .low = 0x1p-1}),
    table_row(
        {"root", "", "err.root"},
        "tells whether a correct hit has the t of another crossing of the same primitive (wrong): within a quarter of "
        "the distance between that crossing and the true one; no_hit: not a correct hit",
        root, {.ramp = Ramp::categories, .domain = MetricDomain::every, .categories = root_names}),
    table_row(
        {"derivative_error", "u", "err.derivative"},
        "error of the derivatives dt/dx, where x is a number of origin, direction, points or lengths: the largest "
        "error of a derivative, divided by the largest derivative of its vector. The derivatives come from forward "
        "differentiation of the form in its format. Forms for unit directions are not differentiated by the "
        "direction; a primitive with a transform has no value",
        derivative_error, {.needs = needs_attribution, .ramp = Ramp::magnitude, .low = 0x1p-1})};

}  // namespace

double ulp_error(const Sample& sample) { return truth::ulp_error(sample.t, *sample.true_t, sample.format->parameters); }
double lost_bits(const Sample& sample) {
    return truth::lost_bits(ulp_error(sample), sample.format->parameters.precision);
}
double correct_bits(const Sample& sample) { return sample.format->parameters.precision - lost_bits(sample); }

/// The ordinals of binary64 need 63 bits and a sign, so the difference of two of them is computed as an unsigned
/// number.
double herbie(const Sample& sample) {
    const auto ordinal_of = [&sample](double x) { return truth::ordinal(x, sample.format->parameters); };
    const auto [low, high] = std::minmax({ordinal_of(sample.t), ordinal_of(sample.rounded_truth)});
    return bits::log2_of(1 + static_cast<double>(static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low)));
}

double absolute_error(const Sample& sample) {
    if (std::isinf(sample.t)) return HUGE_VAL;
    return std::fabs(truth::scaled_difference(truth::as_certified(sample.t), *sample.true_t, 0));
}

double relative_error(const Sample& sample) {
    if (std::isinf(sample.t)) return HUGE_VAL;
    if (sample.true_t->is_zero()) return sample.t == 0 ? 0.0 : HUGE_VAL;
    return std::fabs(truth::scaled_difference(truth::as_certified(sample.t), *sample.true_t, sample.true_t->exponent) /
                     (sample.true_t->hi + sample.true_t->lo));
}

double distance_error(const Sample& sample) {
    const Vec<double>& d = sample.ray->direction;  // if the form requires length one, |d| is one up to rounding
    return absolute_error(sample) * std::hypot(d.x, d.y, d.z);
}

double input_error(const Sample& sample) {
    return sample.stored_truth ? in_ulps(sample, *sample.stored_truth, *sample.true_t) : missing;
}
double model_error(const Sample& sample) {
    return sample.stored_truth && sample.unrounded_t ? in_ulps(sample, *sample.unrounded_t, *sample.stored_truth)
                                                     : missing;
}
double rounding_error(const Sample& sample) {
    if (!sample.unrounded_t) return missing;
    if (std::isinf(sample.t))
        return truth::may_round_to(*sample.unrounded_t, sample.t, sample.format->parameters) ? 0 : sample.t;
    return in_ulps(sample, truth::as_certified(sample.t), *sample.unrounded_t);
}

std::span<const Metric> metrics_of_t() { return rows_of_t; }

}  // namespace lostbits::measure::metric
