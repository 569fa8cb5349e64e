#include "measure/stability/root.hpp"

#include <cmath>

namespace lostbits::measure::stability {
namespace {

/// `see(crossing)` for the first three crossings after `begin`, until it says yes.
template <class See>
bool any_crossing(const Ray<double>& ray, const Solid<double>& solid, Range<double> range, const See& see) {
    intersect::Convention every;
    every.inside = intersect::Inside::exit;
    for (int k = 0; k < 3 && range.holds_any(); ++k) {
        const truth::Truth found = truth::find_truth(ray, solid, {}, every, range);
        if (!found.is_hit()) return false;
        const double at = truth::round_certified(found.t, binary64).value_or(found.t.hi);
        if (see(at)) return true;
        range = {.tmin = std::nextafter(at, HUGE_VAL)};
    }
    return false;
}

}  // namespace

bool is_wrong_root(const Ray<double>& ray, const Solid<double>& solid, const truth::Certified& truth, double t) {
    const double meant = std::ldexp(truth.hi, static_cast<int>(truth.exponent));
    const auto is_at = [&](double other) { return std::fabs(t - other) <= std::fabs(other - meant) / 4; };
    // Beyond what a truth that was rounded to double may be off.
    const double beyond = meant * (1 + 0x1p-50);
    if (any_crossing(ray, solid, {.tmin = beyond, .open = {.tmin = true}}, is_at)) return true;
    const Ray<double> back{ray.origin, -ray.direction};
    return any_crossing(back, solid, {}, [&](double other) { return other != meant && is_at(-other); });
}

}  // namespace lostbits::measure::stability
