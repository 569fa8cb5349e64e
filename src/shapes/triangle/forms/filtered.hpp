// The signs of the three edges, of the plane and of t, if a bound on the rounding proves them. If it does not, or
// leaves t less than 18 correct bits of 24 (47 of 53), the ray is computed again in wider arithmetic: float, double,
// double-double, exact sums. The decision about the closed triangle is never wrong, and neighbours agree about a
// common edge.
#pragma once

#include "intersect/filter_arithmetic.hpp"
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

    /// Calls `watch(way)` for every arithmetic beyond the first that is used.
    template <Number T, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle, Watch& watch) {
        if constexpr (is_exact<T>) {
            const filtered::Determinants<T> of = filtered::determinants_of(ray, triangle);
            return met<T>(filtered::meets<T>(of), named("t", of.k / of.m));
        } else {
            filtered::TriangleDecision<T> known = filtered::settled_in<T>(ray, triangle);
            if (!any_of(!known.proved)) return met<T>(known.hit, known.t);
            if constexpr (number::wide::has_wider_word<T>) {
                if (number::wide::widens<T>()) {
                    watch(FilterArithmetic::wider);
                    known = joined(known, filtered::settled_in<number::wide::OneWord<T>>(ray, triangle));
                    if (!any_of(!known.proved)) return met<T>(known.hit, known.t);
                }
            }
            known = filtered::to_the_end<T>(ray, triangle, known, watch);
            return met<T>(known.hit, known.t);
        }
    }
};

}  // namespace lostbits::intersect::triangle
