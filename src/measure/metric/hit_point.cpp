// Metrics of the hit point: its distance from the surface, its barycentric weights, its normal, and errors for which
// renderers use bounds.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "measure/columns/residual.hpp"
#include "measure/metric/values.hpp"
#include "measure/truth/enclose.hpp"
#include "number/ball.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"
#include "number/tape.hpp"
#include "shapes/box/forms/slab.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

/// P = o + t·d as the format computes it: a product and a sum, each rounded.
Vec<double> hit_point(const Sample& sample) {
    const FloatFormat& f = sample.format->parameters;
    const auto component = [&](double o, double d) {
        switch (sample.format->engine) {
            case Format::Engine::native32: {
                const float step = static_cast<float>(sample.t) * static_cast<float>(d);
                return static_cast<double>(static_cast<float>(o) + step);
            }
            case Format::Engine::native64: return o + sample.t * d;
            case Format::Engine::rounded: break;
        }
        return rounding::add(o, rounding::mul(sample.t, d, f), f);
    };
    return Vec<double>(component(sample.ray->origin.x, sample.ray->direction.x),
                       component(sample.ray->origin.y, sample.ray->direction.y),
                       component(sample.ray->origin.z, sample.ray->direction.z));
}

/// Calls `compute.operator()<F>()`, where F is the machine's own type for the format. Returns `missing` for a format
/// without such a type.
template <class Compute>
double compute_in_format(const Sample& sample, const Compute& compute) {
    switch (sample.format->engine) {
        case Format::Engine::native32: return compute.template operator()<float>();
        case Format::Engine::native64: return compute.template operator()<double>();
        case Format::Engine::rounded: break;
    }
    return missing;
}

template <class F>
Vec<F> to_format(const Vec<double>& v) {
    return {static_cast<F>(v.x), static_cast<F>(v.y), static_cast<F>(v.z)};
}

/// Evaluates `formula.operator()<E>()` in interval arithmetic. The result is off by at most 2^-40 of itself or 2^-90;
/// `missing` if it is unbounded.
template <class Formula>
double evaluate_enclosed(const Formula& formula) {
    const Ball ball = formula.template operator()<Ball>();
    if (ball.is_bounded() && ball.radius() <= std::max(std::fabs(ball.hi()) * 0x1p-40, 0x1p-90)) return ball.hi();
    const Interval::Precision precision(8192);
    const Interval exact = formula.template operator()<Interval>();
    return exact.is_bounded() ? mpfr_get_d(exact.lower(), MPFR_RNDN) : missing;
}

/// Returns `relative_distance` of a primitive at a point in world space. If the primitive has a matrix, both are taken
/// to object space.
template <class E, template <class> class S>
E relative_distance(const Vec<double>& p, const Primitive<double>& primitive) {
    const Primitive<E> lifted = lift_primitive<E>(primitive);
    const Vec<E> point = lift_vec<E>(p);
    return lifted.template as<S>().relative_distance(lifted.transform ? point_to_object_space(point, *lifted.transform)
                                                                      : point);
}

double residual_of(const Vec<double>& p, const Primitive<double>& primitive) {
    return visit(primitive, [&]<template <class> class S>(const S<double>&) {
        const double point[] = {p.x, p.y, p.z};
        const auto coordinate = [&primitive](int k) { return primitive.numbers[k]; };
        if (double fast_result; !primitive.transform && columns::find_residual<S>(point, coordinate, fast_result))
            return fast_result;
        return evaluate_enclosed([&]<class E>() { return relative_distance<E, S>(p, primitive); });
    });
}

/// Value that the form computed for the weight of a vertex, found by the form's name of that weight. Nothing if the
/// form has no name for it.
std::optional<double> computed_weight(const Sample& sample, std::size_t vertex) {
    if (!sample.attribution || sample.weights[vertex].empty()) return std::nullopt;
    const auto& nodes = sample.attribution->tape->nodes;
    const auto found = std::ranges::find(nodes, sample.weights[vertex], &TapeNode::label);
    return found == nodes.end() ? std::nullopt : std::optional(found->value);
}

/// Distance of x from the true weight of a vertex: infinite if x is not finite, missing for a primitive without
/// weights.
double weight_error(double x, const Sample& sample, std::size_t vertex) {
    if (!std::isfinite(x)) return HUGE_VAL;
    return visit_shape(*sample.primitive, [&]<template <class> class S>() {
        if constexpr (requires(const S<double>& shape) { shape.barycentric_coordinates(Ray<double>()); }) {
            return std::fabs(evaluate_enclosed([&]<class E>() {
                return visit_in_object_space<S>(lift_ray<E>(*sample.ray), lift_primitive<E>(*sample.primitive),
                                                [&](const S<E>& shape, const Ray<E>& ray) -> E {
                                                    return E(x) -
                                                           shape.barycentric_coordinates(ray)[static_cast<int>(vertex)];
                                                });
            }));
        } else {
            return missing;
        }
    });
}

/// Largest |x − x*| over the weights x of a, b and c that the form computes, in u = 2^-p. The weight of a point in the
/// triangle is at most 1, whatever the size of the triangle, so no other scale is needed. x* belongs to the ray and the
/// triangle as the form received them. Infinite if a weight is not finite; missing for a form that names no weights,
/// or whose operations cannot be recorded.
double barycentric_error(const Sample& sample) {
    double largest_error = missing;
    for (std::size_t vertex = 0; vertex < sample.weights.size(); ++vertex)
        if (const auto x = computed_weight(sample, vertex))
            largest_error = std::fmax(largest_error, weight_error(*x, sample, vertex));
    return in_roundoffs(largest_error, sample);
}

/// |x + y + z − 1|, in u, for a form that computes all three weights.
double barycentric_sum(const Sample& sample) {
    const auto x = computed_weight(sample, 0), y = computed_weight(sample, 1), z = computed_weight(sample, 2);
    if (!x || !y || !z) return missing;
    if (!std::isfinite(*x) || !std::isfinite(*y) || !std::isfinite(*z)) return HUGE_VAL;
    // A Real holds the sum of three doubles near 1 exactly, or what cancellation leaves of it to 2^-200.
    return in_roundoffs(std::fabs(Real(Real(*x) + Real(*y) + Real(*z) - 1).convert_to<double>()), sample);
}

constexpr Metric rows_of_weights[] = {
    table_row(
        {"barycentric_error", "u", "weights.error"},
        "for a triangle: the largest error of the barycentric coordinates (u, v) that the form computes, |u - u*| "
        "over 2^-p",
        barycentric_error, {.needs = needs_attribution, .ramp = Ramp::magnitude, .low = 0x1p-2}),
    table_row({"barycentric_sum", "u", "weights.sum"},
              "for a triangle: |u + v + w - 1| over 2^-p, for a form that computes all three barycentric coordinates",
              barycentric_sum, {.needs = needs_attribution, .ramp = Ramp::magnitude, .low = 0x1p-2, .high = 0x1p+4})};

template <class F>
inline constexpr double roundoff = std::numeric_limits<F>::epsilon() / 2;

/// Error of a projection as pbrt does it, in object space, whose origin is the centre: p = o + t d, then p r/|p|.
template <class F>
double projection_error(const Sample& sample) {
    const auto [centre, radius] = ball_around(*sample.primitive);
    const auto r = static_cast<F>(radius), t = static_cast<F>(sample.t);
    const Vec<F> o = to_format<F>(sample.ray->origin) - to_format<F>(centre), d = to_format<F>(sample.ray->direction);
    const Vec<F> p = o + Vec<F>(t * d.x, t * d.y, t * d.z);
    const F scale = r / length(p);
    const Ball exact = Ball(double{r}) / length(Vec<Ball>(Ball(double{p.x}), Ball(double{p.y}), Ball(double{p.z})));
    double worst = 0;
    for (int i = 0; i < 3; ++i) {
        if (p[i] == 0) continue;
        const Ball error = Ball(double{p[i] * scale}) / (Ball(double{p[i]}) * exact) - Ball(1);
        if (!error.is_bounded()) return missing;
        worst = std::max(worst, std::fabs(error.hi()));
    }
    return worst / roundoff<F>;
}

/// Padding for the clipping by the slabs alone, as `box.signs` clips, over all t ≥ 0. If tmin exceeds tmax, it is (tmin
/// − tmax)/tmax/u, or infinite if tmax is not positive; otherwise 0.
template <class F>
double padding_in(const Ray<F>& ray, const BoundingBox<F>& box) {
    F tmin = 0, tmax = std::numeric_limits<F>::infinity();
    intersect::box::clip_by_signs<F>(ray, box, tmin, tmax);
    if (!(tmin > tmax)) return 0;
    return tmax > 0 ? (double{tmin} - double{tmax}) / double{tmax} / roundoff<F> : HUGE_VAL;
}

}  // namespace

double residual(const Sample& sample) {
    const Vec<double> p = hit_point(sample);
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return HUGE_VAL;
    return residual_of(p, *sample.primitive);
}

double normal_error(const Sample& sample) {
    if (sample.primitive->transform) return missing;
    const auto normal_at = [](const auto& ray, const auto& primitive, const auto& p) {
        return lift_vec<Real>(visit(primitive, [&](const auto& shape) { return shape.outward_normal(ray, p); }));
    };

    // The normal where the ray truly hits.
    const Ray<Real> ray = lift_ray<Real>(*sample.ray);
    const truth::CertifiedNumber& t = *sample.true_t;
    const Real true_t = ldexp(Real(Real(t.hi) + Real(t.lo)), static_cast<int>(t.exponent));
    const Vec<Real> exact =
        normal_at(ray, lift_primitive<Real>(*sample.primitive), Vec<Real>(ray.origin + true_t * ray.direction));

    // Its angle with the normal that the format computes.
    return compute_in_format(sample, [&]<class F>() {
        const Primitive<F> primitive = lift_primitive<F>(*sample.primitive);
        const Ray<F> ray_in_format{to_format<F>(sample.ray->origin), to_format<F>(sample.ray->direction)};
        const Vec<Real> n = normal_at(ray_in_format, primitive, to_format<F>(hit_point(sample)));
        if (!(dot(n, n) > 0)) return HUGE_VAL;
        return Real(atan2(length(cross(n, exact)), dot(n, exact))).template convert_to<double>();
    });
}

double point_error(const Sample& sample) {
    const Vec<double> p = hit_point(sample);
    const truth::CertifiedNumber& t = *sample.true_t;
    double worst = 0, largest = 0;
    for (int i = 0; i < 3; ++i) {
        const Ball scale(std::ldexp(1, static_cast<int>(std::clamp<std::int64_t>(t.exponent, -800, 800))));
        const Ball exact =
            Ball(sample.ray->origin[i]) + (Ball(t.hi) + Ball(t.lo)) * scale * Ball(sample.ray->direction[i]);
        const Ball error = Ball(p[i]) - exact;
        if (!error.is_bounded()) return HUGE_VAL;
        worst = std::max(worst, std::fabs(error.hi()));
        largest = std::max(largest, std::fabs(p[i]));
    }
    return worst / ((1 + largest) * std::ldexp(1, -sample.format->parameters.precision));
}

double projected_error(const Sample& sample) {
    if (!row_of(sample.primitive->shape).is_ball) return missing;
    return compute_in_format(sample, [&]<class F>() { return projection_error<F>(sample); });
}

double padding(const Sample& sample) {
    const auto padding_of = [&sample](const Ray<double>& ray, const BoundingBox<double>& box) {
        return compute_in_format(sample, [&]<class F>() {
            return padding_in<F>({to_format<F>(ray.origin), to_format<F>(ray.direction)},
                                 {to_format<F>(box.lo), to_format<F>(box.hi)});
        });
    };
    if (sample.levels) {
        double largest = 0;
        for (const auto& level : sample.levels->boxes)
            if (const double box_padding = padding_of(level.ray, level.box); !(box_padding <= largest))
                largest = box_padding;
        return largest;
    }

    if (!sample.true_t || !sample.primitive || sample.primitive->shape != bounding_box_shape) return missing;
    return padding_of(*sample.ray, bounding_box_of(*sample.primitive));
}

double padding(const Ray<float>& ray, const BoundingBox<float>& box) { return padding_in(ray, box); }

std::span<const Metric> metrics_of_barycentrics() { return rows_of_weights; }

}  // namespace lostbits::measure::metric
