// The shape that a form's `intersect` takes, for translation units that may include nothing heavier (see
// packed_batch.hpp).
#pragma once

#include "shapes/solid.hpp"

namespace lostbits::intersect {

template <class Form, template <class> class S>
inline constexpr bool meets = [] {
    if constexpr (S<float>::told_end) return requires(const Ray<float>& ray, const S<float>& solid, float tmax) {
            Form::intersect(ray, solid, tmax);
        };
    else return requires(const Ray<float>& ray, const S<float>& solid) {
            Form::intersect(ray, solid);
        };
}();

/// The shape of a form, from the arguments of its `intersect`: a sphere, a box and the ray's end, …; `sdf` if it takes
/// a field.
template <class Form>
inline constexpr Shape shape_of = [] {
    Shape found = Shape::sdf;
    Solids::each([&found]<template <class> class S>() {
        if constexpr (meets<Form, S>) found = shape_as<S>;
    });
    return found;
}();

/// True if the form marches a field of all primitives together.
template <class Form>
inline constexpr bool marches = !is_solid(shape_of<Form>);

/// Calls `Form::intersect` on a primitive. `tmax` is passed if forms of the shape take the end of the ray, `watch` if
/// it is given.
template <class Form, class T, template <class> class S, class... Watch>
Hit<T> intersect_solid(const Ray<T>& ray, const S<T>& solid, const T& tmax, Watch&... watch) {
    if constexpr (S<T>::told_end) return Form::intersect(ray, solid, tmax, watch...);
    else return Form::intersect(ray, solid, watch...);
}

/// The same on the primitive whose numbers are `number(0)`, `number(1)`, …
template <class Form, class T, class Numbers>
Hit<T> intersect_numbers(const Ray<T>& ray, const Numbers& number, const T& tmax) {
    return Solids::of_shape<shape_of<Form>>(
        [&]<template <class> class S>() { return intersect_solid<Form>(ray, solid_from<S, T>(number), tmax); });
}

}  // namespace lostbits::intersect
