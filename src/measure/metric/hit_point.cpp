#include "measure/metric/hit_point.hpp"

#include <algorithm>
#include <cmath>

#include "number/ball.hpp"
#include "number/interval.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::metric {

using truth::missing;

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

namespace {

/// (|v| − r)/r without cancellation: (v·v − r²)/(r(|v| + r)), v = P − G.
template <class E>
E off_surface(const Vec<double>& p, const Sphere<double>& sphere) {
    const Vec<E> v(E(p.x) - E(sphere.centre.x), E(p.y) - E(sphere.centre.y), E(p.z) - E(sphere.centre.z));
    const E r(sphere.radius);
    const E v2 = square(v);
    return (v2 - square(r)) / (r * (sqrt(v2) + r));
}

/// The largest of lo − p and p − hi over the axes, in longest sides: how far p lies outside the box by its worst
/// component (beside an edge or a corner that is less than the distance), or, negative, how deep inside by the nearest
/// face.
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

}  // namespace

double residual(const Sample& s) {
    const Vec<double> p = hit_point(s);
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return HUGE_VAL;
    return visit(*s.solid, [&p](const auto& shape) { return residual_of(p, shape); });
}

}  // namespace lostbits::measure::metric
