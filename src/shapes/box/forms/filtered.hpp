// `signs` with a bound on the rounding error of each t. If the bound does not prove the decision, the planes are
// compared without dividing, in wider arithmetic and then exactly. The decision about the closed box is never wrong. t
// is that of `signs`: after its three roundings, at least 21 of its 24 bits are correct (50 of 53). If an intermediate
// result overflows, t is computed in a wider number type.
#pragma once

#include "intersect/deciding_arithmetic.hpp"
#include "shapes/box/forms/filtered_steps.hpp"

namespace lostbits::intersect::box {

struct FilteredSlabs {
    static constexpr Info info{
        .name = "box.filtered",
        .title = "signs if a bound proves them, else wider arithmetic",
        .source = "a static filter after Shewchuk 1997; signs of determinants",
    };

    template <Number T, BoxLike<T> B>
    static Hit<T> intersect(const Ray<T>& ray, const B& box, const T& limit) {
        NoWatch watch;
        return intersect(ray, box, limit, watch);
    }

    /// Calls `watch(arithmetic)` for every arithmetic beyond the first that is used.
    template <Number T, BoxLike<T> B, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const B& box, const T& limit, Watch& watch) {
        T tmin(0), tmax = limit;
        if constexpr (is_exact<T>) {
            clip_by_signs(ray, box, tmin, tmax);
            return hit_from_segment<T>(tmin <= tmax, {tmin, tmax});
        } else {
            T overflow_sum(0);
            clip_by_signs(ray, box, tmin, tmax,
                          [&](int /*axis*/, const T& /*inv*/, const T& dmax) { overflow_sum = overflow_sum + dmax; });
            const filtered::BoundDecision<T> bound_decision = filtered::decide_by_bound<T>(tmin, tmax, overflow_sum);
            if (!any_of(!bound_decision.is_proved)) return hit_from_segment<T>(bound_decision.hit, {tmin, tmax});
            return filtered::decide_by_planes<T>(ray, filtered::order_planes<T>(ray, box), {{tmin, tmax}, limit},
                                                 bound_decision, watch);
        }
    }
};

}  // namespace lostbits::intersect::box
