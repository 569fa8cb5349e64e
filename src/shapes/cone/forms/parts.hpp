// Functions that several cone forms share: the caps, and the choice of cap or side by which the line enters and leaves.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/cone/cone.hpp"

namespace lostbits::intersect::cone {

/// The t at which a line crosses the plane of each cap. `in_base` and `in_top` are true if it crosses within the cap.
template <Number T>
struct CapCrossings {
    T base, top;
    mask_t<T> in_base, in_top;
};

/// Compares the points with the caps, as most code does: f + t d relative to the base, and relative to the top.
template <Number T>
CapCrossings<T> caps_by_points(const Cone<T>& cone, const Ray<T>& ray, const T& low, const T& axis_rate, const T& v2) {
    const Vec<T> f = ray.origin - cone.base, g = ray.origin - cone.top;
    const T base = -low / axis_rate, top = (v2 - low) / axis_rate;
    return {base, top, square(Vec<T>(f + base * ray.direction)) <= square(cone.base_radius),
            square(Vec<T>(g + top * ray.direction)) <= square(cone.top_radius)};
}

/// Compares without division: |f (v·d) − d (v·f)| with radius |v·d|, relative to the base. For the top, the vectors are
/// relative to the top.
template <Number T>
CapCrossings<T> caps_without_division(const Cone<T>& cone, const Ray<T>& ray, const T& low, const T& axis_rate) {
    const Vec<T> v = cone.top - cone.base, f = ray.origin - cone.base, g = ray.origin - cone.top;
    const T high = named("v.g", dot(v, g)), across2 = square(axis_rate);
    return {-low / axis_rate, -high / axis_rate,
            square(Vec<T>(axis_rate * f - low * ray.direction)) <= square(cone.base_radius) * across2,
            square(Vec<T>(axis_rate * g - high * ray.direction)) <= square(cone.top_radius) * across2};
}

/// Returns the first t ≥ 0 at which the line enters or leaves. The line does so by a cap if it crosses within the cap.
/// Otherwise it enters by the side at the root where the polynomial falls (`near`), if that root is between the planes,
/// and leaves where the polynomial rises (`far`). A NaN is not between the planes.
template <Number T>
Hit<T> first_of_side_and_caps(const mask_t<T>& no_roots, const RootPair<T>& side, const CapCrossings<T>& caps) {
    const auto base_first = caps.base < caps.top;
    const T first_t = select(base_first, caps.base, caps.top), last_t = select(base_first, caps.top, caps.base);
    const auto in_first = (base_first && caps.in_base) || (!base_first && caps.in_top);
    const auto in_last = (base_first && caps.in_top) || (!base_first && caps.in_base);
    const auto enters_by_side = !no_roots && first_t <= side.near && side.near <= last_t;
    const T near = named("near", select(in_first, first_t, side.near)),
            far = named("far", select(in_last, last_t, side.far));
    // A line parallel to the planes crosses both at infinity, at the same end unless o is between them.
    return hit_unless<T>(!(in_first || enters_by_side), {near, far});
}

}  // namespace lostbits::intersect::cone
