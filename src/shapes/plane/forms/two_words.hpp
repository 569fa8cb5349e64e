// Computes both dot products in two words of the format, and their quotient in one word. The form helps if the eye is
// near a plane that is far from the origin of the world, or if rays run along the plane.
#pragma once

#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "number/wide/two_words.hpp"
#include "shapes/plane/plane.hpp"

namespace lostbits::intersect::plane {

struct TwoWordsPlane {
    static constexpr Info info{
        .name = "plane.two_words",
        .title = "both dot products in two words of the format",
        .source = "two words after Dekker 1971 and Joldes, Muller and Popescu 2017",
        .roots = Roots::first_only,
    };

    static constexpr bool exact_is_apart = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Plane<T>& plane) {
        if constexpr (is_exact<T>) return hit_by_quotient<T>(ray, plane, [](const T& x) { return x; });
        else {
            using W = number::wide::TwoWords<T>;
            const auto wide = [](const Vec<T>& v) { return Vec<W>(W(v.x), W(v.y), W(v.z)); };
            return hit_by_quotient<T>(Ray<W>{wide(ray.origin), wide(ray.direction)},
                                      Plane<W>{wide(plane.through), wide(plane.normal)},
                                      [](const W& x) { return x.hi; });
        }
    }

private:
    /// t = n·(P − o)/(n·d) with both dot products in W. `high_word` rounds a W to T.
    template <Number T, class W, class HighWord>
    static Hit<T> hit_by_quotient(const Ray<W>& ray, const Plane<W>& plane, const HighWord& high_word) {
        const T numerator = named("n.(P-o)", high_word(dot(plane.normal, Vec<W>(plane.through - ray.origin))));
        const T t = named("t", numerator / named("n.d", high_word(dot(plane.normal, ray.direction))));
        return {t >= T(0), t, t, t};
    }
};

}  // namespace lostbits::intersect::plane
