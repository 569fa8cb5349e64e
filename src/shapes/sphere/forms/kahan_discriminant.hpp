// Kahan's discriminant. With FMA, h² − ac is computed to within two ulps of itself: w = ac, e = fma(−a, c, w), disc =
// fma(h, h, −w) + e. The roots are those of Press et al. It repairs the last subtraction, but not the earlier losses
// in h and c.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct KahanDiscriminant {
    static constexpr Info info{
        .name = "sphere.kahan_discriminant",
        .title = "Kahan's FMA discriminant, Press et al. roots",
        .source =
            "Kahan, On the Cost of Floating-Point Computation Without Extra-Precise Arithmetic (2004); pbrt-v4; Boost "
            "quadratic_roots",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T h = named("h", dot(f, ray.direction));
        const T c = named("c", square(f) - square(sphere.radius));
        const T w = named("w", a * c);
        const T e = named("e", fma(-a, c, w));
        const T disc = named("disc", fma_square(h, -w) + e);
        return hit_unless<T>(disc < T(0), unified_roots<T>(a, -h, c, sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::sphere
