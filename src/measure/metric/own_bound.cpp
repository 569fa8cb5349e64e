#include "measure/metric/own_bound.hpp"

#include <cmath>

#include "number/rounded.hpp"

namespace lostbits::measure::metric {

using truth::missing;

double bound(const Sample& s) {
    if (!s.bounded) return missing;
    if (!(s.bounded->error < HUGE_VAL)) return HUGE_VAL;
    return std::ldexp(s.bounded->error, -static_cast<int>(ulp_exponent(s.format->shape, s.truth->floor_log2())));
}

double bound_over(const Sample& s, double error) {
    const double size = bound(s);
    return size == 0 && error == 0 ? 1 : size / std::fabs(error);
}

double decision(const Sample& s) { return s.bounded ? (s.bounded->proved ? 0 : 1) : missing; }

double arithmetic(const Sample& s) { return s.way ? static_cast<double>(*s.way) : missing; }

}  // namespace lostbits::measure::metric
