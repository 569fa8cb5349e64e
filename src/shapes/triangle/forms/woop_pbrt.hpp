// Woop's test as in pbrt: if one edge value is zero, all three are computed again in `Wider<T>` (double for floats).
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

/// Vertices relative to the ray's origin, rotated and sheared until the ray is the z axis, with z in units of the
/// direction.
template <Number T>
struct WoopVertices {
    Vec<T> p0, p1, p2;

    WoopVertices(const Ray<T>& ray, const Triangle<T>& triangle)
        : p0(triangle.a - ray.origin), p1(triangle.b - ray.origin), p2(triangle.c - ray.origin) {
        const LargestComponent<T> axis(absolute_values(ray.direction));
        const Vec<T> d = axis.rotate_to_last(ray.direction);
        const T sx = named("Sx", -d.x / d.z), sy = named("Sy", -d.y / d.z), sz = named("Sz", T(1) / d.z);
        for (Vec<T>* const p : {&p0, &p1, &p2}) {
            const Vec<T> v = axis.rotate_to_last(*p);
            *p = Vec<T>(v.x + sx * v.z, v.y + sy * v.z, v.z * sz);
        }
    }
};

template <Number T>
struct WoopEdges {
    T e0, e1, e2;

    /// `difference_of_products(a, b, c, d)` is a b − c d.
    template <class DifferenceOfProducts>
    WoopEdges(const WoopVertices<T>& v, const DifferenceOfProducts& difference_of_products)
        : e0(difference_of_products(v.p1.x, v.p2.y, v.p1.y, v.p2.x)),
          e1(difference_of_products(v.p2.x, v.p0.y, v.p2.y, v.p0.x)),
          e2(difference_of_products(v.p0.x, v.p1.y, v.p0.y, v.p1.x)) {
        const T zero(0);
        const auto is_zero = [&](const T& e) { return e <= zero && e >= zero; };
        const mask_t<T> needs_wider = is_zero(e0) || is_zero(e1) || is_zero(e2);
        const auto wide_difference = [](const T& a, const T& b, const T& c, const T& d) {
            const auto widen = Wider<T>::widen;
            return Wider<T>::narrow(widen(a) * widen(b) - widen(c) * widen(d));
        };
        e0 = named("e0", select(needs_wider, wide_difference(v.p1.x, v.p2.y, v.p1.y, v.p2.x), e0));
        e1 = named("e1", select(needs_wider, wide_difference(v.p2.x, v.p0.y, v.p2.y, v.p0.x), e1));
        e2 = named("e2", select(needs_wider, wide_difference(v.p0.x, v.p1.y, v.p0.y, v.p1.x), e2));
    }
};

/// Results that pbrt computes from the edge values. `hit` does not yet compare t with its error bound.
template <Number T>
struct WoopHit {
    mask_t<T> hit;
    T t, inverse_determinant;
};

template <Number T>
WoopHit<T> hit_from_edges(const Triangle<T>& triangle, const WoopVertices<T>& v, const WoopEdges<T>& e) {
    const T zero(0);
    // (2 area)², which is zero for a degenerate triangle.
    const T doubled_area_squared = square(cross(triangle.c - triangle.a, triangle.b - triangle.a));
    const mask_t<T> is_any_negative = e.e0 < zero || e.e1 < zero || e.e2 < zero;
    const mask_t<T> is_any_positive = e.e0 > zero || e.e1 > zero || e.e2 > zero;
    const T det = named("det", e.e0 + e.e1 + e.e2);
    const T scaled_t = named("tScaled", e.e0 * v.p0.z + e.e1 * v.p1.z + e.e2 * v.p2.z);
    const mask_t<T> is_ahead = (det < zero && scaled_t < zero) || (det > zero && scaled_t > zero);
    const T inverse_determinant = named("invDet", T(1) / det);
    named("b0", e.e0 * inverse_determinant);
    named("b1", e.e1 * inverse_determinant);
    named("b2", e.e2 * inverse_determinant);
    return {is_not_zero(doubled_area_squared) && !(is_any_negative && is_any_positive) && is_ahead,
            named("t", scaled_t * inverse_determinant), inverse_determinant};
}

}  // namespace lostbits::intersect::triangle
