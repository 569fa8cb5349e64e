// Cesium: the ray is multiplied by 1/r, which is rounded once for all rays. From outside, a ray that points away
// misses. Otherwise the far root is temp/w², and the near root is difference/temp, which subtracts no numbers of
// similar size.
#pragma once

#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct CesiumInterval {
    static constexpr Info info{
        .name = "ellipsoid.cesium",
        .title = "ray times 1/r, stable roots",
        .source = "CesiumGS/cesium 0671b6d, packages/engine/Source/Core/IntersectionTests.js, rayEllipsoid",
    };

    /// q is the origin and w the direction in radii; q² − 1, qw and w² are named as in the source.
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        const Vec<T> inverse = divide_components<T>(Vec<T>(T(1), T(1), T(1)), ellipsoid.radii);
        const Vec<T> q = inverse * (ray.origin - ellipsoid.centre), w = inverse * ray.direction;
        const T qw = named("qw", dot(q, w));
        const T difference = named("difference", square(q) - T(1));
        const T w2 = named("w2", square(w)), product = w2 * difference;
        const T disc = named("disc", square(qw) - product);
        const mask_t<T> is_outside = difference > T(0);
        const T temp = named("temp", -qw + sqrt(disc));
        const T far = temp / w2, near = select(is_outside, difference / temp, T(0));
        const mask_t<T> is_miss =
            (is_outside && (qw >= T(0) || square(qw) < product)) || (!is_outside && difference >= T(0) && qw >= T(0));
        return Hit<T>{!is_miss, named("t", select(is_outside, min(near, far), far)), min(near, far), max(near, far)};
    }
};

}  // namespace lostbits::intersect::ellipsoid
