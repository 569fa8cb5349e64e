// `unified` with a = 1 assumed: "slightly simpler" when the direction is normalised.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct UnifiedUnit {
    static constexpr Info info{
        .name = "sphere.unified_unit",
        .title = "unified, unit direction",
        .source = "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7 (2019), section 7.2",
        .direction = Direction::unit,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T minus_b = named("b'", -dot(f, ray.direction));
        const Vec<T> l = f + minus_b * ray.direction;
        const T delta = named("delta", square(sphere.radius) - square(l));
        const T c = named("c", square(f) - square(sphere.radius));
        const mask_t<T> is_behind = minus_b < T(0);
        const T root = sqrt(delta);
        const T q = named("q", minus_b + select(is_behind, -root, root));
        const T under_c = c / q;
        return hit_unless<T>(delta < T(0), RootPair<T>{select(is_behind, q, under_c), select(is_behind, under_c, q)});
    }
};

}  // namespace lostbits::intersect::sphere
