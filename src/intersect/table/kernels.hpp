// How a form becomes a row: the loops around `Form::intersect`, once for all forms.
#pragma once

#include <limits>

#include "intersect/march.hpp"
#include "intersect/march_watch.hpp"
#include "intersect/table/table.hpp"
#include "intersect/table/union_field.hpp"
#include "intersect/takes.hpp"

namespace lostbits::intersect::table {

/// `Form::intersect` on solid `which` of a target, or on all where the form marches; `tmax` reaches the forms that take
/// the end of a ray, `watch` those that march.
template <class Form, class T, class Watch>
Hit<T> intersect_target(const Ray<T>& ray, const Target<T>& target, const T& tmax, Watch& watch,
                        std::size_t which = 0) {
    if constexpr (marches<Form>) return Form::intersect(ray, Union<T>(target.solids), *target.march, watch);
    else
        return intersect_numbers<Form>(
            ray, [&solid = target.solids[which]](std::size_t k) -> const T& { return solid.numbers[k]; }, tmax);
}

/// `lift(S) -> T` brings a stored number into the arithmetic, `drop(T) -> S` takes the answer back, both exactly or
/// with the one rounding that entering a narrower format costs.
template <class Form, class T, class S, class Lift, class Drop>
void intersect_batch(const RayBatch<S>& rays, const Target<S>& target, const HitBatch<S>& hits, Lift lift, Drop drop) {
    const auto vec = [lift](S x, S y, S z) { return Vec<T>(lift(x), lift(y), lift(z)); };
    const LiftedTarget<T> lifted(target, lift);
    const Target<T> aim = lifted.get();
    const std::size_t step = aim.solids.size() == 1 ? 0 : 1;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray<T> ray{vec(rays.ox[i], rays.oy[i], rays.oz[i]), vec(rays.dx[i], rays.dy[i], rays.dz[i])};
        const T tmax = lift(rays.tmax.empty() ? std::numeric_limits<S>::infinity() : rays.tmax[i]);
        Tally<T> tally;
        const Hit<T> hit = intersect_target<Form>(ray, aim, tmax, tally, i * step);
        hits.hit[i] = hit.hit;
        hits.t[i] = drop(hit.t);
        hits.near[i] = drop(hit.near);
        hits.far[i] = drop(hit.far);
        if constexpr (marches<Form>) {
            if (!hits.march.empty()) hits.march[i] = tally.record(hit, *aim.march, drop);
        }
    }
}

template <class Form, class T>
void native_batch(const RayBatch<T>& rays, const Target<T>& target, const HitBatch<T>& hits) {
    constexpr auto same = [](T x) { return x; };
    intersect_batch<Form, T>(rays, target, hits, same, same);
}

}  // namespace lostbits::intersect::table
