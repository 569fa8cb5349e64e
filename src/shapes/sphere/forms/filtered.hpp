// A cheap method with a bound on its rounding error. If the bound does not prove the decision, or does not guarantee 18
// correct bits of 24 in t (47 of 53), the ray is computed again in wider and wider arithmetic: float, double,
// double-double, exact sums. In packs, one branch for each register tests whether any lane needs the next step. The
// form finds only the first intersection: near = far = t.
#pragma once

#include "intersect/deciding_arithmetic.hpp"
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

    /// Calls `watch(arithmetic)` for every arithmetic beyond the first that is used.
    template <Number T, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere, Watch& watch) {
        if constexpr (is_exact<T>) {
            return to_hit(filtered::decide_unrounded<T>(ray, sphere));
        } else {
            const filter::Decision<T> cheap_decision = filtered::decide_cheaply<T>(ray, sphere);
            if (!any_of(!cheap_decision.is_proved)) return to_hit(cheap_decision);
            if constexpr (number::wide::has_wider_word<T>) {
                if (number::wide::widens<T>()) {
                    watch(DecidingArithmetic::wider);
                    using W = number::wide::OneWord<T>;
                    const filter::Decision<T> wide_decision =
                        prefer_first(cheap_decision, filtered::decide_in_wider<W, T>(ray, sphere));
                    if (!any_of(!wide_decision.is_proved)) return to_hit(wide_decision);
                    return to_hit(filter::finish<filtered::SphereSteps>(ray, sphere, wide_decision, watch));
                }
            }
            return to_hit(filter::finish<filtered::SphereSteps>(ray, sphere, cheap_decision, watch));
        }
    }

private:
    template <Number T>
    static Hit<T> to_hit(const filter::Decision<T>& decision) {
        return {decision.hit, decision.t, decision.t, decision.t};
    }
};

}  // namespace lostbits::intersect::sphere
