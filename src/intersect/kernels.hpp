// How a form becomes a row: the loops around `Form::intersect`, once for all forms.
#pragma once

#include "intersect/catalogue.hpp"
#include "intersect/table.hpp"

namespace lostbits {

/// `lift(S) -> T` brings a stored number into the arithmetic, `drop(T) -> S` takes the answer back, both exactly or
/// with the one rounding that entering a narrower format costs.
template <class Form, class T, class S, class Lift, class Drop>
void intersect_batch(const RayBatch<S>& rays, const Sphere<S>& sphere, const HitBatch<S>& hits, Lift lift, Drop drop) {
    const auto vec = [lift](S x, S y, S z) { return Vec<T>(lift(x), lift(y), lift(z)); };
    const Sphere<T> target{vec(sphere.centre.x, sphere.centre.y, sphere.centre.z), lift(sphere.radius)};
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray<T> ray{vec(rays.ox[i], rays.oy[i], rays.oz[i]), vec(rays.dx[i], rays.dy[i], rays.dz[i])};
        const Hit<T> hit = Form::intersect(ray, target);
        hits.hit[i] = hit.hit;
        hits.t[i] = drop(hit.t);
        hits.near[i] = drop(hit.near);
        hits.far[i] = drop(hit.far);
    }
}

template <class Form, class T>
void native_batch(const RayBatch<T>& rays, const Sphere<T>& sphere, const HitBatch<T>& hits) {
    constexpr auto same = [](T x) { return x; };
    intersect_batch<Form, T>(rays, sphere, hits, same, same);
}

}  // namespace lostbits
