#include "measure/metric/stability.hpp"

#include <cmath>

#include "measure/stability/margin.hpp"
#include "measure/stability/prediction.hpp"
#include "measure/truth/lost_bits.hpp"

namespace lostbits::measure::metric {

using truth::missing, truth::Perturbed, stability::Turned;

namespace {

double in_units(double relative, const Sample& s) { return std::ldexp(relative, s.format->shape.precision); }

double backward(const Sample& s, Perturbed perturbed) {
    if (!s.solid || s.march) return missing;
    return in_units(stability::backward_error(*s.ray, *s.solid, s.t, perturbed, s.convention, s.range), s);
}

double margin(const Sample& s, Turned turned) {
    if (!s.solid || s.march) return missing;
    return in_units(
        stability::decision_margin(*s.ray, *s.solid, turned, Perturbed::componentwise, s.convention, s.range), s);
}

}  // namespace

double backward_error(const Sample& s) { return backward(s, Perturbed::componentwise); }
double backward_error_normwise(const Sample& s) { return backward(s, Perturbed::normwise); }
double decision_margin(const Sample& s) { return margin(s, Turned::root); }

double wrong_decision(const Sample& s) {
    if (!s.solid || s.march) return missing;
    if (!answer::is_wrong(s.outcome)) return 0;
    return margin(s, Turned::decision) > 1 ? 2 : 1;
}

namespace {

/// Whether the tape is of a t whose decision rounding did not turn.
bool explains_t(const Sample& s) {
    return s.blame && !s.march && s.blame->attribution->subject == s.blame->tape->outputs.t;
}

}  // namespace

double cestac_bits(const Sample& s) {
    if (!explains_t(s)) return missing;
    return stability::RandomRuns(*s.blame->tape).correct_bits(s.format->shape.precision);
}

double cestac_error(const Sample& s) {
    if (!explains_t(s)) return missing;
    const int precision = s.format->shape.precision;
    const stability::RandomRuns runs(*s.blame->tape);
    const double error = (runs.mean() - s.t) + s.blame->attribution->error;
    return runs.correct_bits(precision) - (precision - truth::lost_bits(error / s.blame->ulp, precision));
}

double cestac_digit(const Sample& s) {
    const double error = cestac_error(s);
    if (std::isnan(error)) return missing;
    return error >= std::log2(10.0) ? 1 : 0;
}

double cestac_decision(const Sample& s) {
    if (!s.blame || s.march) return missing;
    const bool is_stable = stability::RandomRuns(*s.blame->tape).agree();
    return (is_stable ? 0 : 2) + (answer::is_wrong(s.outcome) ? 1 : 0);
}

double statistical_ratio(const Sample& s) {
    if (!explains_t(s)) return missing;
    const double bound = stability::statistical_bound(*s.blame->tape, *s.blame->attribution);
    const double error = std::fabs(s.blame->attribution->error);
    return error == 0 ? 0 : error / bound;
}

}  // namespace lostbits::measure::metric
