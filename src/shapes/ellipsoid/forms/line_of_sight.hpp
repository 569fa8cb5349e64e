// The quadratic without a division, multiplied out. The radicand is a sum of twelve products, most of which cancel if
// the ellipsoid is far away.
#pragma once

#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct LineOfSight {
    static constexpr Info info{
        .name = "ellipsoid.line_of_sight",
        .title = "multiplied out, near root",
        .source = "geospace-code/pymap3d 0bb4350, src/pymap3d/los.py, lookAtSpheroid",
        .roots = Roots::near_only,
    };

    /// (x, y, z) is the origin relative to the centre, (u, v, w) the direction, (a, b, c) the radii.
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        const Vec<T> f = ray.origin - ellipsoid.centre;
        const T &x = f.x, &y = f.y, &z = f.z, &u = ray.direction.x, &v = ray.direction.y, &w = ray.direction.z;
        const T a2 = square(ellipsoid.radii.x), b2 = square(ellipsoid.radii.y), c2 = square(ellipsoid.radii.z), two(2);
        const T value = named("value", -a2 * b2 * w * z - a2 * c2 * v * y - b2 * c2 * u * x);
        const T terms_1 = a2 * b2 * square(w) + a2 * c2 * square(v) - a2 * square(v) * square(z);
        const T terms_2 = terms_1 + two * a2 * v * w * y * z - a2 * square(w) * square(y) + b2 * c2 * square(u);
        const T terms_3 = terms_2 - b2 * square(u) * square(z) + two * b2 * u * w * x * z - b2 * square(w) * square(x);
        const T radical = named(
            "radical", terms_3 - c2 * square(u) * square(y) + two * c2 * u * v * x * y - c2 * square(v) * square(x));
        const T magnitude = named("magnitude", a2 * b2 * square(w) + a2 * c2 * square(v) + b2 * c2 * square(u));
        const T t =
            named("t", (value - ellipsoid.radii.x * ellipsoid.radii.y * ellipsoid.radii.z * sqrt(radical)) / magnitude);
        return near_hit<T>(radical < T(0), t);
    }
};

}  // namespace lostbits::intersect::ellipsoid
