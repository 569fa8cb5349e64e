#include "measure/metric/hit_point.hpp"

#include <algorithm>
#include <cmath>

#include "measure/truth/enclose.hpp"
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

template <class E>
E off_surface(const Vec<double>& p, const Solid<double>& solid) {
    const Vec<E> point = truth::lift_vec<E>(p);
    return visit(truth::lift_solid<E>(solid), [&point](const auto& shape) { return shape.off_surface(point); });
}

double residual_of(const Vec<double>& p, const Solid<double>& solid) {
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
    return residual_of(p, *s.solid);
}

}  // namespace lostbits::measure::metric
