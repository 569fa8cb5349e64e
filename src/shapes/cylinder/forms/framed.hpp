// An instance along z: a frame from the axis, the ray taken into it, x² + y² = r² there, and the caps z = 0 and
// z = height. The axis and what is across it are rounded, and with them the shape.
#pragma once

#include "shapes/cylinder/forms/parts.hpp"

namespace lostbits::intersect::cylinder {

struct InOwnFrame {
    static constexpr Info info{
        .name = "cylinder.framed",
        .title = "taken into a frame along the axis",
        .source = "pbrt-v4, src/pbrt/shapes.h, Cylinder, with CoordinateSystem (Duff et al. 2017) as its transform",
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Cylinder<T>& cylinder) {
        const Vec<T> axis = cylinder.top - cylinder.base;
        const T height = named("height", length(axis));
        const Vec<T> z(axis.x / height, axis.y / height, axis.z / height);
        const T sign = copysign(T(1), z.z), a = T(-1) / (sign + z.z), b = z.x * z.y * a;
        const Vec<T> x(T(1) + sign * square(z.x) * a, sign * b, -sign * z.x), y(b, sign + square(z.y) * a, -z.y);
        const Vec<T> f = ray.origin - cylinder.base;
        const auto into = [&](const Vec<T>& p) { return Vec<T>(dot(p, x), dot(p, y), dot(p, z)); };
        const Vec<T> o = into(f), d = into(ray.direction);
        const T qa = named("a", square(d.x) + square(d.y)), h = named("h", o.x * d.x + o.y * d.y);
        const T c = named("c", square(o.x) + square(o.y) - square(cylinder.radius));
        const T disc = named("disc", square(h) - qa * c);
        const RootPair<T> caps = between<T>(-o.z / d.z, (height - o.z) / d.z);
        return first_of_both<T>(disc < T(0), sphere::plain_half_roots<T>(qa, h, sqrt(disc)), caps);
    }
};

}  // namespace lostbits::intersect::cylinder
