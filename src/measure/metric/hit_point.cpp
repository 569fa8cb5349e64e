#include "measure/metric/hit_point.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "measure/columns/residual.hpp"
#include "measure/truth/enclose.hpp"
#include "number/rounded.hpp"
#include "number/tape.hpp"

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

/// The number that `find.operator()<E>()` encloses, to 2^-40 of itself or 2^-90; missing where it is unbounded.
template <class Find>
double enclosed(const Find& find) {
    const Ball ball = find.template operator()<Ball>();
    if (ball.is_bounded() && ball.radius() <= std::max(std::fabs(ball.hi()) * 0x1p-40, 0x1p-90)) return ball.hi();
    const Interval::Precision precision(8192);
    const Interval exact = find.template operator()<Interval>();
    return exact.is_bounded() ? mpfr_get_d(exact.lower(), MPFR_RNDN) : missing;
}

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

namespace {

/// What the form computed under the name that it has for the weight of a vertex.
std::optional<double> told(const Sample& s, std::size_t vertex) {
    if (!s.blame || s.weights[vertex].empty()) return std::nullopt;
    const auto& nodes = s.blame->tape->nodes;
    const auto found = std::ranges::find(nodes, s.weights[vertex], &TapeNode::label);
    return found == nodes.end() ? std::nullopt : std::optional(found->value);
}

/// How far a number is from the weight of a vertex.
double error_of(double x, const Sample& s, std::size_t vertex) {
    if (!std::isfinite(x)) return HUGE_VAL;
    return visit_shape(*s.solid, [&]<template <class> class Of>() {
        if constexpr (requires(const Of<double>& shape) { shape.weights(Ray<double>()); }) {
            return std::fabs(enclosed([&]<class E>() {
                return in_its_space<Of>(lift_ray<E>(*s.ray), lift_solid<E>(*s.solid),
                                        [&](const Of<E>& shape, const Ray<E>& ray) -> E {
                                            return E(x) - shape.weights(ray)[static_cast<int>(vertex)];
                                        });
            }));
        } else {
            return missing;
        }
    });
}

double in_roundoffs(double x, const Sample& s) { return std::ldexp(x, s.format->shape.precision); }

}  // namespace

double barycentric_error(const Sample& s) {
    double most = missing;
    for (std::size_t vertex = 0; vertex < s.weights.size(); ++vertex)
        if (const auto x = told(s, vertex)) most = std::fmax(most, error_of(*x, s, vertex));
    return in_roundoffs(most, s);
}

double barycentric_sum(const Sample& s) {
    const auto x = told(s, 0), y = told(s, 1), z = told(s, 2);
    if (!x || !y || !z) return missing;
    if (!std::isfinite(*x) || !std::isfinite(*y) || !std::isfinite(*z)) return HUGE_VAL;
    // A Real holds the sum of three doubles near 1, or what is left of it to 2^-200.
    return in_roundoffs(std::fabs(Real(Real(*x) + Real(*y) + Real(*z) - 1).convert_to<double>()), s);
}

}  // namespace lostbits::measure::metric
