#include "measure/metric/hit_point.hpp"

#include <algorithm>
#include <cmath>

#include "measure/columns/residual.hpp"
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

/// How far a point of the world is off the surface; under a matrix in the space of the solid.
template <class E, template <class> class S>
E off_surface(const Vec<double>& p, const Solid<double>& solid) {
    const Solid<E> lifted = lift_solid<E>(solid);
    const Vec<E> point = lift_vec<E>(p);
    return lifted.template as<S>().off_surface(lifted.placed ? point_in_object(point, *lifted.placed) : point);
}

double residual_of(const Vec<double>& p, const Solid<double>& solid) {
    return visit(solid, [&]<template <class> class S>(const S<double>&) {
        const double point[] = {p.x, p.y, p.z};
        const auto number = [&solid](int k) { return solid.numbers[static_cast<std::size_t>(k)]; };
        if (double quick; !solid.placed && columns::find_residual<S>(point, number, quick)) return quick;
        return enclosed([&]<class E>() { return off_surface<E, S>(p, solid); });
    });
}

}  // namespace

double residual(const Sample& s) {
    const Vec<double> p = hit_point(s);
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return HUGE_VAL;
    return residual_of(p, *s.solid);
}

double normal_error(const Sample& s) {
    if (s.solid->placed) return missing;
    const auto normal_at = [](const auto& ray, const auto& solid, const auto& p) {
        return lift_vec<Real>(visit(solid, [&](const auto& shape) { return shape.outward_normal(ray, p); }));
    };
    const Ray<Real> ray = lift_ray<Real>(*s.ray);
    const truth::Certified& t = *s.truth;
    const Real t_true = ldexp(Real(Real(t.hi) + Real(t.lo)), static_cast<int>(t.exponent));
    const Vec<Real> exact = normal_at(ray, lift_solid<Real>(*s.solid), Vec<Real>(ray.origin + t_true * ray.direction));
    return in_format(s, [&]<class F>() {
        const Solid<F> solid = transformed(*s.solid, [](double x) { return static_cast<F>(x); });
        const Ray<F> given{stored<F>(s.ray->origin), stored<F>(s.ray->direction)};
        const Vec<Real> n = normal_at(given, solid, stored<F>(hit_point(s)));
        if (!(dot(n, n) > 0)) return HUGE_VAL;
        return Real(atan2(length(cross(n, exact)), dot(n, exact))).template convert_to<double>();
    });
}

}  // namespace lostbits::measure::metric
