// How a form becomes a row: the loops around `Form::intersect`, once for all forms.
#pragma once

#include <limits>

#include "intersect/catalogue.hpp"
#include "intersect/table.hpp"
#include "intersect/takes.hpp"

namespace lostbits {

/// The shape that a form's `intersect` takes.
template <class Form>
inline constexpr Shape shape_of = takes_sphere<Form> ? Shape::sphere : Shape::box;

/// `Form::intersect` on a solid of the form's shape; `tmax` reaches the forms that are told where a ray ends.
template <class Form, class T>
Hit<T> intersect_solid(const Ray<T>& ray, const Solid<T>& solid, const T& tmax) {
    if constexpr (shape_of<Form> == Shape::sphere) return Form::intersect(ray, solid.sphere());
    else return Form::intersect(ray, solid.box(), tmax);
}

/// `lift(S) -> T` brings a stored number into the arithmetic, `drop(T) -> S` takes the answer back, both exactly or
/// with the one rounding that entering a narrower format costs.
template <class Form, class T, class S, class Lift, class Drop>
void intersect_batch(const RayBatch<S>& rays, const Solid<S>& solid, const HitBatch<S>& hits, Lift lift, Drop drop) {
    const auto vec = [lift](S x, S y, S z) { return Vec<T>(lift(x), lift(y), lift(z)); };
    const Solid<T> target = transformed(solid, [lift](const S& x) { return lift(x); });
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray<T> ray{vec(rays.ox[i], rays.oy[i], rays.oz[i]), vec(rays.dx[i], rays.dy[i], rays.dz[i])};
        const T tmax = lift(rays.tmax.empty() ? std::numeric_limits<S>::infinity() : rays.tmax[i]);
        const Hit<T> hit = intersect_solid<Form>(ray, target, tmax);
        hits.hit[i] = hit.hit;
        hits.t[i] = drop(hit.t);
        hits.near[i] = drop(hit.near);
        hits.far[i] = drop(hit.far);
    }
}

template <class Form, class T>
void native_batch(const RayBatch<T>& rays, const Solid<T>& solid, const HitBatch<T>& hits) {
    constexpr auto same = [](T x) { return x; };
    intersect_batch<Form, T>(rays, solid, hits, same, same);
}

}  // namespace lostbits
