// The slab method, which several box forms share. A box is the intersection of three slabs, each between two planes at
// right angles to an axis. A ray is inside a slab from the t of one plane to the t of the other.
#pragma once

#include "intersect/info.hpp"
#include "shapes/box/box.hpp"
#include "shapes/box/ordered_box.hpp"

namespace lostbits::intersect::box {

/// The part of the ray inside the slabs so far: the t from tmin to tmax, empty if tmin > tmax.
template <Number T>
struct Segment {
    T tmin;
    T tmax;
};

/// Returns the hit with near = t = tmin ≥ 0, clipped at the origin, and far = tmax. `is_hit` is the result of the
/// form's own last test: true if a part of the ray is inside the box.
template <Number T>
Hit<T> hit_from_segment(const mask_t<T>& is_hit, const Segment<T>& segment) {
    return Hit<T>{is_hit, segment.tmin, segment.tmin, segment.tmax};
}

/// The coordinates of a slab's two planes in the order in which the line meets them.
template <Number T>
struct Planes {
    T first;
    T second;
};

/// Boxes that a form can take if it orders planes only by the sign of 1/d.
template <class B, class T>
concept BoxLike = std::same_as<B, Box<T>> || std::same_as<B, OrderedBox<T>>;

/// Orders the planes: lo before hi if the sign bit of inv = 1/d is clear, hi before lo if it is set. A direction of −0
/// has inv = −∞ and its planes are swapped, so a ray between them still runs from −∞ to +∞.
template <Number T>
Planes<T> planes_by_sign(const Box<T>& box, int axis, const T& inv) {
    const mask_t<T> is_reversed = copysign(T(1), inv) < T(0);
    return {select(is_reversed, box.hi[axis], box.lo[axis]), select(is_reversed, box.lo[axis], box.hi[axis])};
}

/// Returns the planes in the order that the kernel found.
template <Number T>
Planes<T> planes_by_sign(const OrderedBox<T>& box, int axis, const T& /*inv*/) {
    return {box.first[axis], box.second[axis]};
}

/// Clips a ray by all slabs: tmin = max(dmin, tmin), tmax = min(dmax, tmax) with dmin = (first − o)·inv, dmax = (second
/// − o)·inv. A NaN from 0·∞ (a ray in one of the planes) leaves both as they were, because min and max return their
/// second operand if the first is NaN. (The function takes two numbers and not a Segment, because GCC 12 writes a
/// struct of packs to the stack in every iteration.)
///
/// Calls `visit_axis(axis, inv, dmax)` for every axis.
template <Number T, BoxLike<T> B, class VisitAxis>
void clip_by_signs(const Ray<T>& ray, const B& box, T& tmin, T& tmax, const VisitAxis& visit_axis) {
    for (int axis = 0; axis < 3; ++axis) {
        const T inv = named("inv", T(1) / ray.direction[axis]);
        const Planes<T> planes = planes_by_sign<T>(box, axis, inv);
        const T dmin = named("dmin", (planes.first - ray.origin[axis]) * inv);
        const T dmax = named("dmax", (planes.second - ray.origin[axis]) * inv);
        tmin = named("tmin", max(dmin, tmin));
        tmax = named("tmax", min(dmax, tmax));
        visit_axis(axis, inv, dmax);
    }
}
template <Number T, BoxLike<T> B>
void clip_by_signs(const Ray<T>& ray, const B& box, T& tmin, T& tmax) {
    clip_by_signs(ray, box, tmin, tmax, [](int, const T&, const T&) {});
}

/// True if x is not NaN: NaN fails both comparisons.
template <Number T>
mask_t<T> is_number(const T& x) {
    return x < T(0) || x >= T(0);
}

/// Returns the IEEE 754-2008 minNum: if one operand is NaN, in either position, the other one.
template <Number T>
T min_num(const T& a, const T& b) {
    return select(is_number(b), min(a, b), a);
}

/// Returns the IEEE 754-2008 maxNum: if one operand is NaN, in either position, the other one.
template <Number T>
T max_num(const T& a, const T& b) {
    return select(is_number(b), max(a, b), a);
}

}  // namespace lostbits::intersect::box
