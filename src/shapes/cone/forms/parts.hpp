// Functions that several cone forms share: the caps, and the choice of cap or side by which the line enters and leaves.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/cone/cone.hpp"

namespace lostbits::intersect::cone {

/// The t at which a line crosses the plane of each cap. `is_in_base` and `is_in_top` are true
/// if it crosses within the cap.
template <Number T>
struct CapCrossings {
    T base_t, top_t;
    mask_t<T> is_in_base, is_in_top;
};

/// Compares the points with the caps, as most code does: f + t d relative to the base, and relative to the top.
template <Number T>
CapCrossings<T> caps_by_points(const Cone<T>& cone, const Ray<T>& ray, const T& v_dot_f, const T& axis_rate,
                               const T& v2) {
    const Vec<T> f = ray.origin - cone.base, g = ray.origin - cone.top;
    const T base_t = -v_dot_f / axis_rate, top_t = (v2 - v_dot_f) / axis_rate;
    return {base_t, top_t, square(Vec<T>(f + base_t * ray.direction)) <= square(cone.base_radius),
            square(Vec<T>(g + top_t * ray.direction)) <= square(cone.top_radius)};
}

/// Compares without division: |f (v·d) − d (v·f)| with radius |v·d|, relative to the base. For the top, the vectors are
/// relative to the top.
template <Number T>
CapCrossings<T> caps_without_division(const Cone<T>& cone, const Ray<T>& ray, const T& v_dot_f, const T& axis_rate) {
    const Vec<T> v = cone.top - cone.base, f = ray.origin - cone.base, g = ray.origin - cone.top;
    const T v_dot_g = named("v.g", dot(v, g)), axis_rate_square = square(axis_rate);
    return {-v_dot_f / axis_rate, -v_dot_g / axis_rate,
            square(Vec<T>(axis_rate * f - v_dot_f * ray.direction)) <= square(cone.base_radius) * axis_rate_square,
            square(Vec<T>(axis_rate * g - v_dot_g * ray.direction)) <= square(cone.top_radius) * axis_rate_square};
}

/// Returns the first t ≥ 0 at which the line enters or leaves. The line does so by a cap if it crosses within the cap.
/// Otherwise it enters by the side at the root where the polynomial falls (`near`), if that root is between the planes,
/// and leaves where the polynomial rises (`far`). A NaN is not between the planes.
template <Number T>
Hit<T> find_first_of_side_and_caps(const mask_t<T>& has_no_roots, const RootPair<T>& side,
                                   const CapCrossings<T>& caps) {
    const auto is_base_first = caps.base_t < caps.top_t;
    const T first_t = select(is_base_first, caps.base_t, caps.top_t),
            last_t = select(is_base_first, caps.top_t, caps.base_t);
    const auto is_first_cap_crossed = (is_base_first && caps.is_in_base) || (!is_base_first && caps.is_in_top);
    const auto is_last_cap_crossed = (is_base_first && caps.is_in_top) || (!is_base_first && caps.is_in_base);
    const auto enters_by_side = !has_no_roots && first_t <= side.near && side.near <= last_t;
    const T near = named("near", select(is_first_cap_crossed, first_t, side.near)),
            far = named("far", select(is_last_cap_crossed, last_t, side.far));
    // A line parallel to the planes crosses both at infinity, at the same end unless o is between them.
    return hit_unless<T>(!(is_first_cap_crossed || enters_by_side), {near, far});
}

}  // namespace lostbits::intersect::cone
