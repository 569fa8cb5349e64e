// Which shape a form's `intersect` takes, for translation units that may include nothing heavier (see
// packed_batch.hpp).
#pragma once

#include <type_traits>

#include "geometry/solid.hpp"

namespace lostbits::intersect {

/// The shape that a form is of, by what its `intersect` takes: a sphere, a box and the ray's end, or any field.
template <class Form>
inline constexpr Shape shape_of = [] {
    if constexpr (requires(const Ray<float>& ray, const Sphere<float>& sphere) { Form::intersect(ray, sphere); })
        return Shape::sphere;
    else if constexpr (requires(const Ray<float>& ray, const Box<float>& box, float tmax) {
                           Form::intersect(ray, box, tmax);
                       })
        return Shape::box;
    else return Shape::sdf;
}();

}  // namespace lostbits::intersect
