// Float in, double arithmetic, float out: the schoolbook discriminant with the roots of Press et al., all in the wider
// type, with one rounding at the end. The form shows the gain of "just use double".
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct DoubleInside {
    static constexpr Info info{
        .name = "sphere.double_inside",
        .title = "float in, double inside, float out",
        .source = "Mitsuba 0.6, solveQuadraticDouble",
        .formats = Formats::binary32_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        using W = typename Wider<T>::type;
        const auto widen = [](const Vec<T>& v) {
            return Vec<W>(Wider<T>::widen(v.x), Wider<T>::widen(v.y), Wider<T>::widen(v.z));
        };
        const Vec<W> d = widen(ray.direction);
        const Vec<W> f = widen(ray.origin) - widen(sphere.centre);
        const W r = Wider<T>::widen(sphere.radius);
        const W a = named("a", square(d));
        const W b = named("b", W(2) * dot(f, d));
        const W c = named("c", square(f) - square(r));
        const W disc = named("disc", square(b) - W(4) * a * c);
        const Hit<W> wide = hit_unless<W>(disc < W(0), press_roots<W>(a, b, c, sqrt(disc)));
        return Hit<T>{wide.hit, Wider<T>::narrow(wide.t), Wider<T>::narrow(wide.near), Wider<T>::narrow(wide.far)};
    }
};

}  // namespace lostbits::intersect::sphere
