// Shared by several cone forms: the caps, and the choice of cap or side by which the line enters and leaves.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/cone/cone.hpp"

namespace lostbits::intersect::cone {

/// The t at which a line passes each of the two planes; `in_base` and `in_top` say whether it does so within the cap.
template <Number T>
struct CapsPassed {
    T base, top;
    mask_t<T> in_base, in_top;
};

/// Compares the points themselves with the caps, as most code does: f + t d from the base and from the top.
template <Number T>
CapsPassed<T> caps_by_points(const Cone<T>& cone, const Ray<T>& ray, const T& low, const T& across, const T& v2) {
    const Vec<T> f = ray.origin - cone.base, g = ray.origin - cone.top;
    const T base = -low / across, top = (v2 - low) / across;
    return {base, top, square(Vec<T>(f + base * ray.direction)) <= square(cone.base_radius),
            square(Vec<T>(g + top * ray.direction)) <= square(cone.top_radius)};
}

/// Compares without division: |f (v·d) − d (v·f)| with radius |v·d|. The top uses vectors from the top itself.
template <Number T>
CapsPassed<T> caps_without_division(const Cone<T>& cone, const Ray<T>& ray, const T& low, const T& across) {
    const Vec<T> v = cone.top - cone.base, f = ray.origin - cone.base, g = ray.origin - cone.top;
    const T high = named("v.g", dot(v, g)), across2 = square(across);
    return {-low / across, -high / across,
            square(Vec<T>(across * f - low * ray.direction)) <= square(cone.base_radius) * across2,
            square(Vec<T>(across * g - high * ray.direction)) <= square(cone.top_radius) * across2};
}

/// The first t ≥ 0 at which the line enters or leaves. It does so by a cap if it passes within it, else by the side,
/// at the root where the polynomial falls (`near`) or rises (`far`), if that root is between the planes. A NaN is not
/// a root between them.
template <Number T>
Hit<T> first_of_side_and_caps(const mask_t<T>& no_roots, const RootPair<T>& side, const CapsPassed<T>& caps) {
    const auto up = caps.base < caps.top;
    const T low = select(up, caps.base, caps.top), high = select(up, caps.top, caps.base);
    const auto in_low = (up && caps.in_base) || (!up && caps.in_top);
    const auto in_high = (up && caps.in_top) || (!up && caps.in_base);
    const auto by_side = !no_roots && low <= side.near && side.near <= high;
    const T near = named("near", select(in_low, low, side.near)), far = named("far", select(in_high, high, side.far));
    // A line parallel to the planes passes both at infinity, on one side of o unless o is between them.
    return hit_unless<T>(!(in_low || by_side), {near, far});
}

}  // namespace lostbits::intersect::cone
