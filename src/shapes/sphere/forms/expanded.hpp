// The segment form of a ray-casting course. The direction is d = P1 − P0, computed when the ray is made. c = G·G + O·O
// − 2 G·O − r² contains the square of the scene's distance from the world origin. The six squares are added from left
// to right, as the source writes them: cx·cx + cy·cy + cz·cz + x0·x0 + y0·y0 + z0·z0. The form finds the near root
// only.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct Expanded {
    static constexpr Info info{
        .name = "sphere.expanded",
        .title = "segment form with the square of f expanded",
        .source = "Ray-Casting Formulas (course notes)",
        .roots = Roots::near_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T a = named("a", square(ray.direction));
        const T b = named("b", T(2) * dot(f, ray.direction));
        const T squares = square(sphere.centre) + square(ray.origin.x) + square(ray.origin.y) + square(ray.origin.z);
        const T c = named("c", squares - T(2) * dot(sphere.centre, ray.origin) - square(sphere.radius));
        const T disc = named("disc", square(b) - T(4) * a * c);
        return near_hit<T>(disc < T(0), (-b - sqrt(disc)) / (T(2) * a));
    }
};

}  // namespace lostbits::intersect::sphere
