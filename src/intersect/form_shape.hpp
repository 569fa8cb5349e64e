// The shape that a form's `intersect` takes, for translation units that may include no larger headers (see
// packed_batch.hpp).
#pragma once

#include "shapes/primitive.hpp"

namespace lostbits::intersect {

template <class Form, template <class> class S>
inline constexpr bool meets = [] {
    if constexpr (S<float>::takes_tmax) return requires(const Ray<float>& ray, const S<float>& primitive, float tmax) {
            Form::intersect(ray, primitive, tmax);
        };
    else return requires(const Ray<float>& ray, const S<float>& primitive) {
            Form::intersect(ray, primitive);
        };
}();

/// The shape of a form, from the parameters of its `intersect`: `sphere` for a sphere, `box` for a box and the ray's
/// end, …; `sdf` if it takes a distance field.
template <class Form>
inline constexpr Shape shape_of = [] {
    Shape shape = Shape::sdf;
    Primitives::each([&shape]<template <class> class S>() {
        if constexpr (meets<Form, S>) shape = shape_as<S>;
    });
    return shape;
}();

/// True if the form marches through the distance field of all primitives together.
template <class Form>
inline constexpr bool marches = !is_primitive(shape_of<Form>);

/// Calls `Form::intersect` on a primitive. `tmax` is passed if forms of the shape take the end of the ray, `watch` if
/// it is given.
template <class Form, class T, template <class> class S, class... Watch>
Hit<T> intersect_primitive(const Ray<T>& ray, const S<T>& primitive, const T& tmax, Watch&... watch) {
    if constexpr (S<T>::takes_tmax) return Form::intersect(ray, primitive, tmax, watch...);
    else return Form::intersect(ray, primitive, watch...);
}

/// Calls `Form::intersect` on the primitive whose numbers are `number_at(0)`, `number_at(1)`, …
template <class Form, class T, class Numbers>
Hit<T> intersect_numbers(const Ray<T>& ray, const Numbers& number_at, const T& tmax) {
    return Primitives::of_shape<shape_of<Form>>([&]<template <class> class S>() {
        return intersect_primitive<Form>(ray, primitive_from<S, T>(number_at), tmax);
    });
}

}  // namespace lostbits::intersect
