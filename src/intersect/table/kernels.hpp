// The loops around `Form::intersect`, from which the functions of a table row are made.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

#include "intersect/form_shape.hpp"
#include "intersect/march.hpp"
#include "intersect/march_watch.hpp"
#include "intersect/table/table.hpp"
#include "intersect/table/union_field.hpp"
#include "number/with_number.hpp"

namespace lostbits::intersect::table {

/// Calls `Form::intersect` on the primitive with index `primitive_index` of a target, or on all primitives if the form
/// marches. `tmax` is passed to forms that take the end of a ray, `watch` to forms that march.
template <class Form, class T, class Watch>
Hit<T> intersect_target(const Ray<T>& ray, const Target<T>& target, const T& tmax, Watch& watch,
                        std::size_t primitive_index = 0) {
    if constexpr (marches<Form>) return Form::intersect(ray, UnionField<T>(target.primitives), *target.march, watch);
    else
        return intersect_numbers<Form>(
            ray,
            [&primitive = target.primitives[primitive_index]](std::size_t k) -> const T& {
                return primitive.numbers[k];
            },
            tmax);
}

/// Pointer to the `intersect_target` of a form, for code that is compiled once for all forms.
template <class T, class Watch>
using EvaluateTarget = Hit<T> (*)(const Ray<T>&, const Target<T>&, const T&, Watch&, std::size_t);

/// Runs a form over a batch in T, which holds the stored numbers, of type S, exactly or rounded once to a narrower
/// format. `evaluate` is the `intersect_target` of the form; `marches` is true if the form marches.
template <class T, class S, class Evaluate, class Marches>
void intersect_batch(const Evaluate& evaluate, Marches marches, const RayBatch<S>& rays, const Target<T>& target,
                     const HitBatch<S>& hits) {
    const auto to_stored = [](const T& x) {
        if constexpr (std::same_as<T, S>) return x;
        else return as_double(x);
    };
    const auto vec = [](S x, S y, S z) { return Vec<T>(T(x), T(y), T(z)); };
    const std::size_t stride = target.primitives.size() == 1 ? 0 : 1;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray<T> ray{vec(rays.ox[i], rays.oy[i], rays.oz[i]), vec(rays.dx[i], rays.dy[i], rays.dz[i])};
        const T tmax(rays.tmax.empty() ? std::numeric_limits<S>::infinity() : rays.tmax[i]);
        MarchRecorder<T> recorder;
        const Hit<T> hit = evaluate(ray, target, tmax, recorder, i * stride);

        hits.hit[i] = hit.hit;
        hits.t[i] = to_stored(hit.t);
        hits.near[i] = to_stored(hit.near);
        hits.far[i] = to_stored(hit.far);
        if (marches && !hits.march.empty()) hits.march[i] = recorder.record(hit, *target.march, to_stored);
    }
}

template <class Form, class T>
void intersect_native_batch(const RayBatch<T>& rays, const Target<T>& target, const HitBatch<T>& hits) {
    const auto evaluate = [](const Ray<T>& ray, const Target<T>& single_target, const T& tmax,
                             MarchRecorder<T>& recorder, std::size_t primitive_index) {
        return intersect_target<Form>(ray, single_target, tmax, recorder, primitive_index);
    };
    intersect_batch(evaluate, std::bool_constant<marches<Form>>(), rays, target, hits);
}

}  // namespace lostbits::intersect::table
