#include "measure/metric/metrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "measure/blame/culprits.hpp"
#include "measure/truth/conditioning.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::metric {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

std::int64_t ulp_of_truth(const Sample& s) { return ulp_exponent(s.format->shape, s.truth->floor_log2()); }

/// (x − y) in ulps of the format at t*.
double in_ulps(const Sample& s, const truth::Certified& x, const truth::Certified& y) {
    return truth::scaled_difference(x, y, ulp_of_truth(s));
}

double ulp_error(const Sample& s) {
    if (std::isinf(s.t)) return s.t;
    return in_ulps(s, truth::exactly(s.t), *s.truth);
}

double lost(const Sample& s) { return lost_bits(ulp_error(s), s.format->shape.precision); }
double correct(const Sample& s) { return s.format->shape.precision - lost(s); }

double herbie(const Sample& s) {
    const FloatFormat& f = s.format->shape;
    const auto apart = static_cast<double>(std::abs(truth::ordinal(s.t, f) - truth::ordinal(s.truth_rounded, f)));
    return std::log2(1 + apart);
}

double absolute(const Sample& s) {
    if (std::isinf(s.t)) return HUGE_VAL;
    return std::fabs(truth::scaled_difference(truth::exactly(s.t), *s.truth, 0));
}

double relative(const Sample& s) {
    if (std::isinf(s.t)) return HUGE_VAL;
    if (s.truth->is_zero()) return s.t == 0 ? 0.0 : HUGE_VAL;
    return std::fabs(truth::scaled_difference(truth::exactly(s.t), *s.truth, s.truth->exponent) /
                     (s.truth->hi + s.truth->lo));
}

/// P = o + t·d as the format computes it: a product and a sum, each rounded.
Vec<double> hit_point(const Sample& s) {
    const FloatFormat& f = s.format->shape;
    const auto along = [&](double o, double d) {
        switch (s.format->engine) {
            case Format::Engine::native32: {
                const float step = static_cast<float>(s.t) * static_cast<float>(d);
                return static_cast<double>(static_cast<float>(o) + step);
            }
            case Format::Engine::native64: return o + s.t * d;
            case Format::Engine::rounded: break;
        }
        return rounding::add(o, rounding::mul(s.t, d, f), f);
    };
    return Vec<double>(along(s.ray->origin.x, s.ray->direction.x), along(s.ray->origin.y, s.ray->direction.y),
                       along(s.ray->origin.z, s.ray->direction.z));
}

/// (|v| − r)/r without cancellation: (v·v − r²)/(r(|v| + r)), v = P − G.
template <class E>
E off_surface(const Vec<double>& p, const Sphere<double>& sphere) {
    const Vec<E> v(E(p.x) - E(sphere.centre.x), E(p.y) - E(sphere.centre.y), E(p.z) - E(sphere.centre.z));
    const E r(sphere.radius);
    const E v2 = dot(v, v);
    return (v2 - r * r) / (r * (sqrt(v2) + r));
}

/// How far p lies outside the box (negative: inside), by its worst component, in longest sides.
template <class E>
E off_surface(const Vec<double>& p, const Box<double>& box) {
    const auto beyond = [&](int i) { return max(E(box.lo[i]) - E(p[i]), E(p[i]) - E(box.hi[i])); };
    const auto side = [&](int i) { return E(box.hi[i]) - E(box.lo[i]); };
    return max(max(beyond(0), beyond(1)), beyond(2)) / max(max(side(0), side(1)), side(2));
}

template <class Solid>
double residual_of(const Vec<double>& p, const Solid& solid) {
    const Ball quick = off_surface<Ball>(p, solid);
    // Good to 2^-40 of itself, or so small that a double's rounding noise hides it.
    if (quick.is_bounded() && quick.radius() <= std::max(std::fabs(quick.hi()) * 0x1p-40, 0x1p-90)) return quick.hi();
    const Interval::Precision precision(8192);
    const Interval exact = off_surface<Interval>(p, solid);
    return exact.is_bounded() ? mpfr_get_d(exact.lower(), MPFR_RNDN) : missing;
}

double residual(const Sample& s) {
    const Vec<double> p = hit_point(s);
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return HUGE_VAL;
    return s.solid->shape == Shape::sphere ? residual_of(p, s.solid->sphere()) : residual_of(p, s.solid->box());
}

double input_error(const Sample& s) { return s.own ? in_ulps(s, *s.own, *s.truth) : missing; }
double model_error(const Sample& s) { return s.own && s.self ? in_ulps(s, *s.self, *s.own) : missing; }
double rounding_error(const Sample& s) {
    if (!s.self) return missing;
    return std::isinf(s.t) ? s.t : in_ulps(s, truth::exactly(s.t), *s.self);
}

double condition_number(const Sample& s) { return s.condition; }
double inherent(const Sample& s) { return truth::inherent_bits(s.condition, s.format->shape.precision); }
double excess(const Sample& s) { return std::max(0.0, lost(s) - inherent(s)); }

double iterations(const Sample& s) { return s.march ? s.march->iterations : missing; }
double stop(const Sample& s) { return s.march ? static_cast<double>(s.march->stop) : missing; }
double overshoot(const Sample& s) { return s.march ? std::max(0.0, -s.march->deepest) : missing; }
double least_field(const Sample& s) { return s.march ? s.march->least : missing; }

double culprit(const Sample& s) { return s.blame ? s.blame->culprit : missing; }
double cancelled(const Sample& s) { return s.blame ? blame::worst_cancellation(*s.blame->attribution) : missing; }

constexpr unsigned split = needs_own_truth | needs_self;

constexpr std::array table{
    Metric{"lost_bits", "bits", "bits.lost", "clamp(log2(2|ulp_error|), 0, p): significand bits that are wrong",
           needs_nothing, Ramp::bits, 0, 0, true, lost},
    Metric{"correct_bits", "bits", "bits.correct", "p - lost_bits", needs_nothing, Ramp::bits, 0, 0, false, correct},
    Metric{"herbie_bits", "bits", "bits.herbie",
           "log2(1 + |ordinal(t) - ordinal(RN(t*))|): Herbie's and FPBench's measure", needs_rounded_truth, Ramp::bits,
           0, 0, false, herbie},
    Metric{"ulp_error", "ulp", "err.ulp", "(t - t*)/ulp(t*), signed, against the unrounded truth", needs_nothing,
           Ramp::magnitude, 0x1p-4, 0x1p+24, true, ulp_error},
    Metric{"relative_error", "1", "err.relative", "|t - t*|/|t*|", needs_nothing, Ramp::magnitude, 0x1p-30, 1, true,
           relative},
    Metric{"absolute_error", "t", "err.absolute", "|t - t*|, in units of t", needs_nothing, Ramp::magnitude, 0x1p-30,
           0x1p+10, false, absolute},
    Metric{"residual", "size", "err.residual",
           "(|P - G| - r)/r for P = o + t d computed in the format: how far the hit point is off the surface; of a "
           "box: how far outside, in longest sides",
           needs_nothing, Ramp::magnitude, 0x1p-30, 1, true, residual},
    Metric{"input_error", "ulp", "split.input", "(t* of the inputs as the format holds them - t*)/ulp(t*)",
           needs_own_truth, Ramp::magnitude, 0x1p-4, 0x1p+24, false, input_error},
    Metric{"model_error", "ulp", "split.model", "(the form without rounding - t* of its inputs)/ulp(t*)", split,
           Ramp::magnitude, 0x1p-4, 0x1p+24, false, model_error},
    Metric{"rounding_error", "ulp", "split.rounding",
           "(t - the form without rounding)/ulp(t*); the three sum to ulp_error", needs_self, Ramp::magnitude, 0x1p-4,
           0x1p+24, false, rounding_error},
    Metric{"condition", "1", "condition.kappa",
           "kappa = sum |x_i dt/dx_i| / |t| over all inputs of the ray and the sphere it truly hits", needs_condition,
           Ramp::magnitude, 1, 0x1p+30, false, condition_number},
    Metric{"inherent_bits", "bits", "condition.inherent",
           "bits that half an ulp in each input alone would cost: lost bits of max(1/2, kappa/2) ulp", needs_condition,
           Ramp::bits, 0, 0, false, inherent},
    Metric{"excess_bits", "bits", "condition.excess", "lost_bits beyond inherent_bits: what the formula itself loses",
           needs_condition, Ramp::bits, 0, 0, false, excess},
    Metric{"cancellation", "bits", "culprit.cancellation",
           "bits of the largest cancellation on the way to t whose operands were already wrong", needs_attribution,
           Ramp::bits, 0, 0, false, cancelled},
    Metric{"culprit", "", "culprit.operation",
           "the operation whose rounding contributes most to the error of t, or to a decision that rounding changed",
           needs_attribution, Ramp::categories, 0, 0, false, culprit, Over::blamed},
    Metric{"iterations", "samples", "march.iterations", "samples of the field that the march took", needs_nothing,
           Ramp::magnitude, 1, 0x1p+8, true, iterations, Over::marches},
    Metric{"stop", "", "march.stop", "why the march ended; stagnated: at the step cap, with t + d == t", needs_nothing,
           Ramp::categories, 0, 0, true, stop, Over::marches, intersect::stop_names},
    Metric{"least_field", "length", "march.least_field", "smallest |field| that the march sampled", needs_nothing,
           Ramp::magnitude, 0x1p-30, 0x1p+4, true, least_field, Over::marches},
    Metric{"overshoot", "length", "march.overshoot",
           "how deep inside the march sampled the field: max(0, -field); from outside it is 0 in exact arithmetic",
           needs_nothing, Ramp::magnitude, 0x1p-30, 0x1p+4, false, overshoot, Over::marches},
};

}  // namespace

std::span<const Metric> metrics() { return table; }

const Metric* find_metric(std::string_view name) {
    const auto found = std::ranges::find(table, name, &Metric::name);
    return found == table.end() ? blame::labelled_metric(name) : &*found;
}

double lost_bits(double ulps, int precision) {
    const double size = std::fabs(ulps);
    if (!(size > 0.5)) return 0;
    return std::min(std::log2(size) + 1, static_cast<double>(precision));
}

}  // namespace lostbits::measure::metric
