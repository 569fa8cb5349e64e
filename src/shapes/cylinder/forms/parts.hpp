// Functions that several cylinder forms share. They intersect the interval between the caps with that inside the side.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/cylinder/cylinder.hpp"

namespace lostbits::intersect::cylinder {

/// Returns the t of the caps in ascending order, for a line that crosses the base and the top at these t.
template <Number T>
RootPair<T> order_caps(const T& base, const T& top) {
    return {min(base, top), max(base, top)};
}

/// Returns the first t ≥ 0 of near and far, the ends of the interval in which the line is inside the side and between
/// the caps. A NaN fails every test, as in `hit_unless`.
template <Number T>
Hit<T> find_first_of_side_and_caps(const mask_t<T>& is_miss, const RootPair<T>& side, const RootPair<T>& caps) {
    const T near = named("near", select(side.near < caps.near, caps.near, side.near));
    const T far = named("far", select(caps.far < side.far, caps.far, side.far));
    return hit_unless<T>(is_miss || far < near, {near, far});
}

/// Does the same, but handles lines parallel to the axis (a = 0) separately: they are inside the side if c ≤ 0, and
/// miss otherwise.
template <Number T>
Hit<T> find_first_of_side_and_caps(const T& a, const T& c, const T& disc, const RootPair<T>& side,
                                   const RootPair<T>& caps) {
    const mask_t<T> is_parallel = a <= T(0);
    return find_first_of_side_and_caps<T>((is_parallel && c > T(0)) || (!is_parallel && disc < T(0)),
                                          select(is_parallel, caps, side), caps);
}

}  // namespace lostbits::intersect::cylinder
