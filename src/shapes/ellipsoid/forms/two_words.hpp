// The quadratic in two words of the format, the roots in one. A GPU without doubles can use it for an eye near the
// ground, where c = |f/r|² − 1 and the discriminant keep only the digits that the height leaves of the radius.
#pragma once

#include "number/wide/two_words.hpp"
#include "shapes/ellipsoid/forms/in_radii.hpp"

namespace lostbits::intersect::ellipsoid {

struct InTwoWords {
    static constexpr Info info{
        .name = "ellipsoid.two_words",
        .title = "quadratic in two words of the format, stable roots",
        .source = "two words after Dekker 1971 and Joldes, Muller and Popescu 2017",
    };

    static constexpr bool exact_is_apart = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Ellipsoid<T>& e) {
        if constexpr (is_exact<T>) return met<T>(RayInRadii<T>(ray, e), [](const T& x) { return x; });
        else {
            using W = number::wide::TwoWords<T>;
            const auto wide = [](const Vec<T>& v) { return Vec<W>(W(v.x), W(v.y), W(v.z)); };
            const Ray<W> wide_ray{wide(ray.origin), wide(ray.direction)};
            return met<T>(RayInRadii<W>(wide_ray, {wide(e.centre), wide(e.radii)}), [](const W& x) { return x.hi; });
        }
    }

private:
    template <Number T, class W, class First>
    static Hit<T> met(const RayInRadii<W>& in, const First& first) {
        const W a = square(in.d), h = dot(in.f, in.d), c = square(in.f) - W(1);
        const T disc = named("disc", first(square(h) - a * c));
        return hit_unless<T>(disc < T(0), unified_roots<T>(named("a", first(a)), named("b'", -first(h)),
                                                           named("c", first(c)), sqrt(disc)));
    }
};

}  // namespace lostbits::intersect::ellipsoid
