#include "measure/metric/stability.hpp"

#include <cmath>

#include "measure/truth/margin.hpp"

namespace lostbits::measure::metric {

using truth::missing, truth::Perturbed, truth::Turned;

namespace {

double in_units(double relative, const Sample& s) { return std::ldexp(relative, s.format->shape.precision); }

double backward(const Sample& s, Perturbed perturbed) {
    if (!s.solid || s.march) return missing;
    return in_units(truth::backward_error(*s.ray, *s.solid, s.t, perturbed, s.convention, s.range), s);
}

double margin(const Sample& s, Turned turned) {
    if (!s.solid || s.march) return missing;
    return in_units(truth::decision_margin(*s.ray, *s.solid, turned, Perturbed::componentwise, s.convention, s.range),
                    s);
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

}  // namespace lostbits::measure::metric
