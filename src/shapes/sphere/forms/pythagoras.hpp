// The right triangle: tca = −f·d, l² = f·f − tca², t = tca ∓ √(r² − l²), unit direction. The squares are subtracted,
// not the components.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct Pythagoras {
    static constexpr Info info{
        .name = "sphere.pythagoras",
        .title = "right triangle, unit direction",
        .source = "glm::intersectRaySphere (GLM gtx/intersect); POV-Ray",
        .direction = Direction::unit,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T tca = named("tca", -dot(f, ray.direction));
        const T l2 = named("l2", square(f) - square(tca));
        const T r2 = square(sphere.radius);
        const T thc = named("thc", sqrt(r2 - l2));
        return hit_unless<T>(l2 > r2, RootPair<T>{tca - thc, tca + thc});
    }
};

}  // namespace lostbits::intersect::sphere
