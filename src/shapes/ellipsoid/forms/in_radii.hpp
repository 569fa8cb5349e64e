// Transforms a ray to the coordinates in which an ellipsoid is the unit sphere, and its quadratic.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/ellipsoid/ellipsoid.hpp"

namespace lostbits::intersect::ellipsoid {

/// Returns a/b, component by component.
template <Number T>
Vec<T> divide_components(const Vec<T>& a, const Vec<T>& b) {
    return {a.x / b.x, a.y / b.y, a.z / b.z};
}

/// A ray o + t d in units of the radii r, relative to the centre G of the ellipsoid. The members are f = (o − G)/r and
/// d/r.
template <Number T>
struct ScaledRay {
    Vec<T> f, d;

    ScaledRay(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid)
        : f(divide_components<T>(ray.origin - ellipsoid.centre, ellipsoid.radii)),
          d(divide_components<T>(ray.direction, ellipsoid.radii)) {}
};

/// Coefficients a, h = b/2 and c of the quadratic, from the squares of the radii r. With f = o − G, over the
/// components: a = Σ d d/r², h = Σ f d/r², c = Σ f f/r² − 1.
template <Number T>
struct WeightedQuadratic {
    T a, h, c;

    WeightedQuadratic(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) : a(0), h(0), c(0) {
        const Vec<T> f = ray.origin - ellipsoid.centre, &d = ray.direction;
        const Vec<T> w = divide_components<T>(Vec<T>(T(1), T(1), T(1)), ellipsoid.radii * ellipsoid.radii);
        a = named("a", dot(d * d, w));
        h = named("h", dot(f * d, w));
        c = named("c", dot(f * f, w) - T(1));
    }
};

}  // namespace lostbits::intersect::ellipsoid
