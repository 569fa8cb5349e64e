// sphere.half_b with 19 of its 28 operations in double, the smallest set that was found for
// 16 correct bits of every hit, no wrong decision on every pixel of rtg-fig-7-3-4100-oblique.
// Made by lostbits mend rtg-fig-7-3-4100-oblique -i sphere.half_b -f f32 --bits 16 --size 96x96
#pragma once

#include "intersect/info.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits::intersect::sphere {

struct HalfBMended {
    static constexpr Info info{
        .name = "sphere.half_b_mended",
        .title = "sphere.half_b, 19 of its 28 operations in double",
        .source = "lostbits mend rtg-fig-7-3-4100-oblique -i sphere.half_b -f f32 --bits 16 --size 96x96",
        .formats = Formats::binary32_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        using W = typename Wider<T>::type;
        const auto wide = [](const T& x) { return Wider<T>::widen(x); };
        const auto narrow = [](const W& x) { return Wider<T>::narrow(x); };
        const Vec<T>&o = ray.origin, &d = ray.direction;
        const T o_minus_centre_z = o.z - sphere.centre.z;
        const T o_minus_centre_y = o.y - sphere.centre.y;
        const T o_minus_centre_x = o.x - sphere.centre.x;
        const W a = named("a", square(wide(d.x)) + square(wide(d.y)) + square(wide(d.z)));
        const W s12 = wide(o_minus_centre_x) * wide(d.x) + wide(o_minus_centre_y) * wide(d.y);
        const W h = named("h", s12 + wide(o_minus_centre_z) * wide(d.z));
        const W s18 = square(wide(o_minus_centre_x)) + square(wide(o_minus_centre_y));
        const W c = named("c", s18 + square(wide(o_minus_centre_z)) - wide(square(sphere.radius)));
        const W disc = named("disc", square(h) - a * c);
        const T s24 = sqrt(narrow(disc));
        const T s27 = (narrow(-h) - s24) / narrow(a);
        const T s30 = (narrow(-h) + s24) / narrow(a);
        const T t = named("t", select(s27 < T(0), s30, s27));
        return {not((disc < W(0)) or (t < T(0))), t, s27, s30};
    }
};

}  // namespace lostbits::intersect::sphere
