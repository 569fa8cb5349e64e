// A cheap method with a bound on its rounding error. If the bound does not prove the decision, or leaves t less than
// 18 correct bits of 24 (47 of 53), the ray is computed again in wider arithmetic, and then in still wider: float,
// double, double-double, exact sums. In packs, one branch for each register asks whether any lane needs it. It finds
// the first intersection only: near = far = t.
#pragma once

#include "intersect/filter_arithmetic.hpp"
#include "shapes/sphere/forms/filtered_steps.hpp"

namespace lostbits::intersect::sphere {

struct Filtered {
    static constexpr Info info{
        .name = "sphere.filtered",
        .title = "cheap if its bound proves it, else wider arithmetic",
        .source = "a running bound after Higham, Accuracy and Stability, 3.3, as a filter after Shewchuk 1997",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        NoWatch watch;
        return intersect(ray, sphere, watch);
    }

    /// Calls `watch(way)` for every arithmetic beyond the first that is used.
    template <Number T, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere, Watch& watch) {
        if constexpr (is_exact<T>) {
            return answered(filtered::unrounded<T>(ray, sphere));
        } else {
            const filtered::Settled<T> cheap = filtered::cheaply<T>(ray, sphere);
            if (!any_of(!cheap.proved)) return answered(cheap);
            if constexpr (number::wide::has_wider_word<T>) {
                if (number::wide::widens<T>()) {
                    watch(FilterArithmetic::wider);
                    using W = number::wide::OneWord<T>;
                    const filtered::Settled<T> wide = joined(cheap, filtered::widely<W, T>(ray, sphere));
                    if (!any_of(!wide.proved)) return answered(wide);
                    return answered(filtered::to_the_end<T>(ray, sphere, wide, watch));
                }
            }
            return answered(filtered::to_the_end<T>(ray, sphere, cheap, watch));
        }
    }

private:
    template <Number T>
    static Hit<T> answered(const filtered::Settled<T>& v) {
        return {v.hit, v.t, v.t, v.t};
    }
};

}  // namespace lostbits::intersect::sphere
