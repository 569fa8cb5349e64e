// `unified` with c = (|f| − r)(|f| + r), so that the last cancellation in c comes before the squaring.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct FactoredC {
    static constexpr Info info{
        .name = "sphere.factored_c",
        .title = "unified with c factored",
        .source = "-",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T minus_b = named("b'", -dot(f, ray.direction));
        const Vec<T> l = f + (minus_b / a) * ray.direction;
        const T delta = named("delta", square(sphere.radius) - square(l));

        const T len = named("|f|", length(f));
        const T c = named("c", (len - sphere.radius) * (len + sphere.radius));
        return hit_unless<T>(delta < T(0), unified_roots<T>(a, minus_b, c, sqrt(a * delta)));
    }
};

}  // namespace lostbits::intersect::sphere
