// Decides by the signs of three edge determinants, of the plane and of t, if a bound on the rounding proves them. If
// the bound does not prove them, or does not guarantee 18 correct bits of 24 in t (47 of 53), the ray is computed again
// in wider arithmetic: float, double, double-double, exact sums. The decision about the closed triangle is never wrong,
// and neighbours agree about an edge that they share.
#pragma once

#include "intersect/deciding_arithmetic.hpp"
#include "shapes/triangle/forms/filtered_steps.hpp"

namespace lostbits::intersect::triangle {

struct FilteredTriangle {
    static constexpr Info info{
        .name = "triangle.filtered",
        .title = "signs of determinants if a bound proves them, else wider arithmetic",
        .source = "an a-priori bound after Higham, Accuracy and Stability, 3.1, as a filter after Shewchuk 1997",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        NoWatch watch;
        return intersect(ray, triangle, watch);
    }

    /// Calls `watch(arithmetic)` for every arithmetic beyond the first that is used.
    template <Number T, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle, Watch& watch) {
        if constexpr (is_exact<T>) {
            const filtered::Determinants<T> determinants = filtered::compute_determinants(ray, triangle);
            return single_hit<T>(filtered::is_hit_by_signs<T>(determinants),
                                 named("t", determinants.k / determinants.m));
        } else {
            filter::Decision<T> decision = filtered::decide_in<T>(ray, triangle);
            if (!any_of(!decision.is_proved)) return single_hit<T>(decision.hit, decision.t);
            if constexpr (number::wide::has_wider_word<T>) {
                if (number::wide::widens<T>()) {
                    watch(DecidingArithmetic::wider);
                    decision = prefer_first(decision, filtered::decide_in<number::wide::OneWord<T>>(ray, triangle));
                    if (!any_of(!decision.is_proved)) return single_hit<T>(decision.hit, decision.t);
                }
            }
            decision = filter::finish<filtered::TriangleSteps>(ray, triangle, decision, watch);
            return single_hit<T>(decision.hit, decision.t);
        }
    }
};

}  // namespace lostbits::intersect::triangle
