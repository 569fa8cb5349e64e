// The shape that a form's `intersect` takes, for translation units that may include nothing heavier (see
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

/// The shape of a form, from the arguments of its `intersect`: a sphere, a box and the ray's end, …; `sdf` if it takes
/// a field.
template <class Form>
inline constexpr Shape shape_of = [] {
    Shape found = Shape::sdf;
    Primitives::each([&found]<template <class> class S>() {
        if constexpr (meets<Form, S>) found = shape_as<S>;
    });
    return found;
}();

/// True if the form marches a field of all primitives together.
template <class Form>
inline constexpr bool marches = !is_primitive(shape_of<Form>);

/// Calls `Form::intersect` on a primitive. `tmax` is passed if forms of the shape take the end of the ray, `watch` if
/// it is given.
template <class Form, class T, template <class> class S, class... Watch>
Hit<T> intersect_primitive(const Ray<T>& ray, const S<T>& primitive, const T& tmax, Watch&... watch) {
    if constexpr (S<T>::takes_tmax) return Form::intersect(ray, primitive, tmax, watch...);
    else return Form::intersect(ray, primitive, watch...);
}

/// The same on the primitive whose numbers are `number(0)`, `number(1)`, …
template <class Form, class T, class Numbers>
Hit<T> intersect_numbers(const Ray<T>& ray, const Numbers& number, const T& tmax) {
    return Primitives::of_shape<shape_of<Form>>(
        [&]<template <class> class S>() { return intersect_primitive<Form>(ray, primitive_from<S, T>(number), tmax); });
}

}  // namespace lostbits::intersect
