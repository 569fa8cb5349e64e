// Where a form says that the ray meets the solid, and how far that is off the surface.
#pragma once

#include <algorithm>
#include <cmath>

#include "measure/metric/metrics.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"

namespace lostbits::measure::metric {

/// P = o + t·d as the format computes it: a product and a sum, each rounded.
Vec<double> hit_point(const Sample& s);

/// (|P − G| − r)/r; of a box the largest of lo − P and P − hi over the axes, in longest sides.
double residual(const Sample& s);

/// The angle between the normal of the solid at the hit point and at the true one, of a solid under no matrix.
double normal_error(const Sample& s);

/// The number that `find.operator()<E>()` encloses, to 2^-40 of itself or 2^-90; missing where it is unbounded.
template <class Find>
double enclosed(const Find& find) {
    const Ball ball = find.template operator()<Ball>();
    if (ball.is_bounded() && ball.radius() <= std::max(std::fabs(ball.hi()) * 0x1p-40, 0x1p-90)) return ball.hi();
    const Interval::Precision precision(8192);
    const Interval exact = find.template operator()<Interval>();
    return exact.is_bounded() ? mpfr_get_d(exact.lower(), MPFR_RNDN) : truth::missing;
}

/// `in.operator()<F>()` in the machine's own format; missing in every other.
template <class In>
double in_format(const Sample& s, const In& in) {
    switch (s.format->engine) {
        case Format::Engine::native32: return in.template operator()<float>();
        case Format::Engine::native64: return in.template operator()<double>();
        case Format::Engine::rounded: break;
    }
    return truth::missing;
}

template <class F>
Vec<F> stored(const Vec<double>& v) {
    return {static_cast<F>(v.x), static_cast<F>(v.y), static_cast<F>(v.z)};
}

}  // namespace lostbits::measure::metric
