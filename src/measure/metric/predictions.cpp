#include "measure/metric/predictions.hpp"

#include <cmath>

#include "measure/blame/prediction.hpp"
#include "measure/truth/lost_bits.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

/// Whether the tape is of a t whose decision rounding did not turn.
bool explains_t(const Sample& s) {
    return s.blame && !s.march && s.blame->attribution->subject == s.blame->tape->outputs.t;
}

}  // namespace

double cestac_bits(const Sample& s) {
    if (!explains_t(s)) return missing;
    return blame::RandomRuns(*s.blame->tape).correct_bits(s.format->shape.precision);
}

double cestac_error(const Sample& s) {
    if (!explains_t(s)) return missing;
    const int precision = s.format->shape.precision;
    const blame::RandomRuns runs(*s.blame->tape);
    const double error = (runs.mean() - s.t) + s.blame->attribution->error;
    return runs.correct_bits(precision) - (precision - truth::lost_bits(error / s.blame->ulp, precision));
}

double cestac_decision(const Sample& s) {
    if (!s.blame || s.march) return missing;
    const bool is_stable = blame::RandomRuns(*s.blame->tape).agree();
    return (is_stable ? 0 : 2) + (answer::is_wrong(s.outcome) ? 1 : 0);
}

double statistical_ratio(const Sample& s) {
    if (!explains_t(s)) return missing;
    const double bound = blame::statistical_bound(*s.blame->tape, *s.blame->attribution);
    const double error = std::fabs(s.blame->attribution->error);
    return error == 0 ? 0 : error / bound;
}

}  // namespace lostbits::measure::metric
