// Ericson: the quadratic from dot products with the axis, md = m·d, nd = n·d and so on. The square of n × d is computed
// as a = (d·d)(n·n) − nd²; c is computed in the same way. A line parallel to the axis misses or goes through both caps.
#pragma once

#include "shapes/cylinder/forms/parts.hpp"

namespace lostbits::intersect::cylinder {

struct DotProductsCylinder {
    static constexpr Info info{
        .name = "cylinder.dot_products",
        .title = "quadratic from dot products with the axis",
        .source = "Ericson, Real-Time Collision Detection (2005), section 5.3.7, IntersectSegmentCylinder",
    };

    /// d is the axis, n the direction, and m the origin relative to the base, as in the source.
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cylinder<T>& cylinder) {
        const Vec<T> d = cylinder.top - cylinder.base, m = ray.origin - cylinder.base;
        const Vec<T>& n = ray.direction;
        const T md = named("md", dot(m, d)), nd = named("nd", dot(n, d)), dd = named("dd", square(d));
        const T nn = square(n), mn = named("mn", dot(m, n));
        const T a = named("a", dd * nn - square(nd));
        const T k = named("k", square(m) - square(cylinder.radius));
        const T c = named("c", dd * k - square(md));
        const T b = named("b", dd * mn - nd * md);
        const T disc = named("disc", square(b) - a * c);
        const RootPair<T> caps = order_caps<T>(-md / nd, (dd - md) / nd);
        return find_first_of_side_and_caps<T>(a, c, disc, plain_half_roots<T>(a, b, sqrt(disc)), caps);
    }
};

}  // namespace lostbits::intersect::cylinder
