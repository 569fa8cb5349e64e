// Plücker's test as in Embree and Cycles. The vertices are taken relative to the ray's origin. The test of the edge
// from x to y is the sign of d·((y − x) × (y + x)), which is twice d·(x × y). The order of x and y changes only the
// sign.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

template <Number T>
struct PluckerEdges {
    Vec<T> v0, v1, v2;  ///< the vertices relative to the origin
    Vec<T> e0, e1, e2;
    T u, v;                  ///< the tests of the edges opposite p1 and p2
    T least, greatest, sum;  ///< taken over all three tests

    PluckerEdges(const Ray<T>& ray, const Vec<T>& p0, const Vec<T>& p1, const Vec<T>& p2)
        : v0(p0 - ray.origin),
          v1(p1 - ray.origin),
          v2(p2 - ray.origin),
          e0(v2 - v0),
          e1(v0 - v1),
          e2(v1 - v2),
          u(0),
          v(0),
          least(0),
          greatest(0),
          sum(0) {
        const auto test = [&](const Vec<T>& edge, const Vec<T>& x, const Vec<T>& y) {
            return dot_from_z(cross(edge, Vec<T>(x + y)), ray.direction);
        };
        u = named("U", test(e0, v2, v0));
        v = named("V", test(e1, v0, v1));
        const T w = named("W", test(e2, v1, v2));
        least = min(min(u, v), w);
        greatest = max(max(u, v), w);
        sum = named("UVW", u + v + w);
    }
};

}  // namespace lostbits::intersect::triangle
