// Shared by several cylinder forms: caps by planes, roots by the quadratic, and the intersection of the two intervals.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/cylinder/cylinder.hpp"

namespace lostbits::intersect::cylinder {

/// The t of the nearer cap and that of the other, for a line that passes the caps at these t in either order.
template <Number T>
RootPair<T> between(const T& base, const T& top) {
    return {min(base, top), max(base, top)};
}

/// The first t ≥ 0 of near and far, the interval in which the line is inside the side and between the caps. A NaN
/// fails every test, as in `hit_unless`.
template <Number T>
Hit<T> first_of_both(const mask_t<T>& missed, const RootPair<T>& side, const RootPair<T>& caps) {
    const T near = named("near", select(side.near < caps.near, caps.near, side.near));
    const T far = named("far", select(caps.far < side.far, caps.far, side.far));
    return hit_unless<T>(missed || far < near, {near, far});
}

/// The same, with lines parallel to the axis, a = 0, handled separately: they are within the side, c ≤ 0, or miss.
template <Number T>
Hit<T> first_of_both(const T& a, const T& c, const T& disc, const RootPair<T>& side, const RootPair<T>& caps) {
    const mask_t<T> beside = a <= T(0);
    return first_of_both<T>((beside && c > T(0)) || (!beside && disc < T(0)), select(beside, caps, side), caps);
}

}  // namespace lostbits::intersect::cylinder
