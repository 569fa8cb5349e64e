// Computes the quadratic in two words of the format, and the roots in one word. A GPU without doubles can use the form
// for an eye near the ground. There, c = |f/r|² − 1 and the discriminant cancel, and in one word they lose about
// log2(radius/height) bits.
#pragma once

#include "number/wide/two_words.hpp"
#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct TwoWordsEllipsoid {
    static constexpr Info info{
        .name = "ellipsoid.two_words",
        .title = "quadratic in two words of the format, stable roots",
        .source = "two words after Dekker 1971 and Joldes, Muller and Popescu 2017",
    };

    static constexpr bool exact_is_apart = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& ellipsoid) {
        if constexpr (is_exact<T>)
            return hit_from_scaled_ray<T>(ScaledRay<T>(ray, ellipsoid), [](const T& x) { return x; });
        else {
            using W = number::wide::TwoWords<T>;
            const auto wide = [](const Vec<T>& v) { return Vec<W>(W(v.x), W(v.y), W(v.z)); };
            const Ray<W> wide_ray{wide(ray.origin), wide(ray.direction)};
            return hit_from_scaled_ray<T>(ScaledRay<W>(wide_ray, {wide(ellipsoid.centre), wide(ellipsoid.radii)}),
                                          [](const W& x) { return x.hi; });
        }
    }

private:
    /// Solves the quadratic of a ray in units of the radii. `high_word` rounds a W to T.
    template <Number T, class W, class HighWord>
    static Hit<T> hit_from_scaled_ray(const ScaledRay<W>& scaled_ray, const HighWord& high_word) {
        const W a = square(scaled_ray.d), h = dot(scaled_ray.f, scaled_ray.d), c = square(scaled_ray.f) - W(1);
        const T disc = named("disc", high_word(square(h) - a * c));
        return hit_unless<T>(disc < T(0), unified_roots<T>(named("a", high_word(a)), named("b'", -high_word(h)),
                                                           named("c", high_word(c)), sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::ellipsoid
