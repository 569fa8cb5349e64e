// Both dot products in two words of the format, the quotient in one. It is for eyes near a plane that is far from the
// origin of the world, or for rays along the plane.
#pragma once

#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "number/wide/two_words.hpp"
#include "shapes/plane/plane.hpp"

namespace lostbits::intersect::plane {

struct DotsInTwoWords {
    static constexpr Info info{
        .name = "plane.two_words",
        .title = "both dot products in two words of the format",
        .source = "two words after Dekker 1971 and Joldes, Muller and Popescu 2017",
        .roots = Roots::first_only,
    };

    static constexpr bool exact_is_apart = true;

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Plane<T>& plane) {
        if constexpr (is_exact<T>) return met<T>(ray, plane, [](const T& x) { return x; });
        else {
            using W = number::wide::TwoWords<T>;
            const auto wide = [](const Vec<T>& v) { return Vec<W>(W(v.x), W(v.y), W(v.z)); };
            return met<T>(Ray<W>{wide(ray.origin), wide(ray.direction)},
                          Plane<W>{wide(plane.through), wide(plane.normal)}, [](const W& x) { return x.hi; });
        }
    }

private:
    template <Number T, class W, class First>
    static Hit<T> met(const Ray<W>& ray, const Plane<W>& plane, const First& first) {
        const T from = named("n.(P-o)", first(dot(plane.normal, Vec<W>(plane.through - ray.origin))));
        const T t = named("t", from / named("n.d", first(dot(plane.normal, ray.direction))));
        return {t >= T(0), t, t, t};
    }
};

}  // namespace lostbits::intersect::plane
