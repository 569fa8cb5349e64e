// A primitive of any shape as plain numbers. Kernels, files and searches pass it around without knowing the shape.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "shapes/on_one_line.hpp"
#include "shapes/rows.hpp"
#include "shapes/transform.hpp"

namespace lostbits {

/// Largest number of stored numbers of a primitive: those of its shape, then those of its matrix.
inline constexpr std::size_t max_primitive_number_count = max_number_count + Affine<double>::number_count;

/// A shape and its numbers in storage type S. Entries beyond the numbers of the shape are zero. A transform takes the
/// primitive to the world. Without a transform, its numbers are in world coordinates.
template <class S>
struct Primitive {
    Shape shape = shape_rows.front().shape;
    std::array<S, max_number_count> numbers = zeros();
    std::optional<Transform<S>> transform = {};

    Primitive() = default;
    explicit Primitive(Shape initial_shape) : shape(initial_shape) {}
    template <template <class> class Of>
    requires(shape_as<Of> != Shape::sdf) Primitive(const Of<S>& primitive) : shape(shape_as<Of>) {
        std::size_t k = 0;
        for_each_number(primitive, [&](const S& x) { numbers[k++] = x; });
    }

    /// Returns the numbers of the shape, without those of its matrix.
    [[nodiscard]] std::span<const S> shape_numbers() const {
        return std::span(numbers).first(row_of(shape).number_count);
    }
    [[nodiscard]] std::span<S> shape_numbers() { return std::span(numbers).first(row_of(shape).number_count); }

    template <template <class> class Of>
    [[nodiscard]] bool is() const {
        return shape == shape_as<Of>;
    }
    /// Returns the primitive as the struct `Of` of its shape. `shape` must be the shape of `Of`.
    template <template <class> class Of>
    [[nodiscard]] Of<S> as() const {
        return primitive_from<Of, S>([this](std::size_t k) { return numbers[k]; });
    }
    /// Returns the point whose first coordinate is the number at index `k`.
    [[nodiscard]] Vec<S> point(std::size_t k) const { return {numbers[k], numbers[k + 1], numbers[k + 2]}; }
    void set_point(std::size_t k, const Vec<S>& p) {
        numbers[k] = p.x;
        numbers[k + 1] = p.y;
        numbers[k + 2] = p.z;
    }
#define LOSTBITS_LINE(folder, S_) \
    [[nodiscard]] S_<S> folder() const { return as<S_>(); }
    LOSTBITS_SHAPES(LOSTBITS_LINE)
#undef LOSTBITS_LINE

private:
    static std::array<S, max_number_count> zeros() {
        return []<std::size_t... k>(std::index_sequence<k...>) {
            return std::array<S, max_number_count>{(static_cast<void>(k), S(0))...};
        }
        (std::make_index_sequence<max_number_count>());
    }
};

/// Calls `act.template operator()<Of>()` with the struct of the primitive's shape, such as `Sphere`.
template <class S, class Act>
decltype(auto) visit_shape(const Primitive<S>& primitive, const Act& act) {
    return Primitives::visit_shape(primitive, act);
}

/// Calls `act` with the primitive as the struct of its shape. `act` is a template, or has an overload for every shape.
template <class S, class Act>
decltype(auto) visit(const Primitive<S>& primitive, const Act& act) {
    return visit_shape(primitive,
                       [&]<template <class> class Of>() -> decltype(auto) { return act(primitive.template as<Of>()); });
}

/// Scales a primitive by k > 0 about the origin, without its matrix.
template <class S>
Primitive<S> scaled(const Primitive<S>& primitive, const S& k) {
    Primitive<S> result(primitive.shape);
    std::size_t i = 0;
    for (const Key& key : row_of(primitive.shape).keys)
        for (const std::size_t end = i + key.count(); i < end; ++i)
            result.numbers[i] = key.kind == Key::Kind::direction ? primitive.numbers[i] : k * primitive.numbers[i];
    return result;
}

/// Sets d·d in every part of a span to that of the world ray. Before, it is that of the ray in the primitive's space.
template <class Span, class S>
void set_direction_square(Span& span, const S& d2) {
    span.d2 = d2;
    if constexpr (requires { span.side.d2; }) set_direction_square(span.side, d2);
    if constexpr (requires { span.primitive.d2; }) set_direction_square(span.primitive, d2);
    if constexpr (requires { span.enter.d2; }) {
        set_direction_square(span.enter, d2);
        set_direction_square(span.leave, d2);
    }
}

/// Calls `act(shape, ray)` with a primitive of shape `Of` and the ray, both in the space of the primitive.
template <template <class> class Of, class S, class Act>
auto visit_in_object_space(const Ray<S>& ray, const Primitive<S>& primitive, const Act& act) {
    if (!primitive.transform) return act(primitive.template as<Of>(), ray);
    const ObjectSpaceRay<S> in = to_object_space(ray, *primitive.transform);
    return act(scaled(primitive, in.scale).template as<Of>(), in.ray);
}

/// Returns the interval in which the ray's line is inside a primitive of shape `Of`. Distances are in the world.
template <template <class> class Of, class S>
auto span_of(const Ray<S>& ray, const Primitive<S>& primitive) {
    auto span = visit_in_object_space<Of>(
        ray, primitive, [](const Of<S>& shape, const Ray<S>& object_ray) { return shape.span(object_ray); });
    if (primitive.transform) set_direction_square(span, square(ray.direction));
    return span;
}

/// Calls `act` with the interval in which the ray's line is inside the primitive.
template <class S, class Act>
auto with_span(const Ray<S>& ray, const Primitive<S>& primitive, const Act& act) {
    return visit_shape(primitive, [&]<template <class> class Of>() { return act(span_of<Of>(ray, primitive)); });
}

/// Returns centre and radius of a ball that holds the primitive. Under a stored matrix, |A p| ≤ ‖A‖ |p| with the
/// Frobenius norm. Do not call it for a primitive under a stored inverse.
template <class S>
auto ball_around(const Primitive<S>& primitive) {
    auto ball = visit(primitive, [](const auto& shape) { return shape.ball_around(); });
    if (primitive.transform) {
        const Affine<S> m = primitive.transform->map();
        ball.centre = m.point(ball.centre);
        ball.radius = sqrt(square(m.rows[0]) + square(m.rows[1]) + square(m.rows[2])) * ball.radius;
    }
    return ball;
}

/// Builds a primitive of this shape around a point. It extends `half` from the point on each axis.
template <class S>
Primitive<S> primitive_around(Shape shape, const Vec<S>& point, const S& half) {
    Primitive<S> primitive(shape);
    visit_shape(primitive, [&]<template <class> class Of>() { primitive = Of<S>::around(point, half); });
    return primitive;
}

/// Converts each number by `lift`, in order. The numbers of the matrix come last.
template <class S, class Lift>
auto convert_numbers(const Primitive<S>& primitive, Lift lift) {
    Primitive<std::decay_t<std::invoke_result_t<Lift, const S&>>> result(primitive.shape);
    for (std::size_t i = 0; i < primitive.shape_numbers().size(); ++i) result.numbers[i] = lift(primitive.numbers[i]);
    if (primitive.transform) result.transform = convert_numbers(*primitive.transform, lift);
    return result;
}

/// True if two points differ and none of their numbers is NaN.
template <class S>
bool are_apart(const Vec<S>& a, const Vec<S>& b) {
    bool any_differs = false;
    for (int i = 0; i < 3; ++i) {
        if (!(a[i] < b[i] || a[i] >= b[i])) return false;
        any_differs = any_differs || a[i] != b[i];
    }
    return any_differs;
}

/// A limit that a primitive breaks: its key, and the index of the number that breaks it. For a point this is the index
/// of its first coordinate. NaN breaks every limit.
struct BrokenLimit {
    const Key* key;
    std::size_t number_index;
};
template <class S>
std::optional<BrokenLimit> broken_limit(const Primitive<S>& primitive) {
    std::size_t k = 0;
    for (const Key& key : row_of(primitive.shape).keys) {
        // Limits of points.
        if (key.limit == Key::Limit::not_collinear_with_previous &&
            are_on_one_line(primitive.point(k - 6), primitive.point(k - 3), primitive.point(k)))
            return BrokenLimit{&key, k};
        if (key.limit == Key::Limit::differs_from_previous && !are_apart(primitive.point(k - 3), primitive.point(k)))
            return BrokenLimit{&key, k};
        if (key.limit == Key::Limit::not_zero && !are_apart(Vec<S>(S(0), S(0), S(0)), primitive.point(k)))
            return BrokenLimit{&key, k};

        // Limits of numbers.
        for (const std::size_t end = k + key.count(); k < end; ++k) {
            const S& x = primitive.numbers[k];
            if ((key.limit == Key::Limit::positive && !(x > S(0))) ||
                (key.limit == Key::Limit::not_negative && !(x >= S(0))) ||
                (key.limit == Key::Limit::non_negative_below_previous &&
                 !(x >= S(0) && x < primitive.numbers[k - 1])) ||
                (key.limit == Key::Limit::positive_below_previous && !(x > S(0) && x < primitive.numbers[k - 1])) ||
                (key.limit == Key::Limit::at_least_previous && !(primitive.numbers[k - key.count()] <= x)))
                return BrokenLimit{&key, k};
        }
    }
    return std::nullopt;
}

/// Calls `act(key, index of its first number)` for each key of the shape.
template <class Act>
void for_each_key(Shape shape, const Act& act) {
    std::size_t k = 0;
    for (const Key& key : row_of(shape).keys) {
        act(key, k);
        k += key.count();
    }
}

/// True if the number at index k may be left out.
inline bool is_optional(Shape shape, std::size_t k) {
    bool optional = false;
    for_each_key(shape, [&](const Key& key, std::size_t first) {
        if (k >= first && k < first + key.count()) optional = key.is_optional;
    });
    return optional;
}

/// A key that is a length, and the index of its number.
struct LengthKey {
    const Key* key;
    std::size_t number_index;
};
/// Returns the first length of a shape; nothing if it has none.
inline std::optional<LengthKey> length_key(Shape shape) {
    std::optional<LengthKey> found;
    for_each_key(shape, [&found](const Key& key, std::size_t k) {
        if (!found && key.kind == Key::Kind::length) found = LengthKey{&key, k};
    });
    return found;
}

}  // namespace lostbits
