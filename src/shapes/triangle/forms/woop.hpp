// Woop's test: the largest component of the direction is rotated to z, the triangle is sheared until the ray is the z
// axis, and the edges are tested in the plane. Each vertex is sheared separately, so two triangles agree about an edge
// that they share.
#pragma once

#include "shapes/triangle/forms/parts.hpp"

namespace lostbits::intersect::triangle {

struct Woop {
    static constexpr Info info{
        .name = "triangle.woop",
        .title = "Woop's watertight test, no second look at zeros",
        .source = "Embree 05bf30e, kernels/geometry/triangle_intersector_woop.h:87; rcp as 1/x",
        .roots = Roots::first_only,
        .at_origin = AtOrigin::miss,
        .weights = {"u", "v", ""},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const LargestComponent<T> axis(absolute_values(ray.direction));
        const auto rotate = [&](const Vec<T>& v) {  // the source exchanges x and y
            const Vec<T> last = axis.rotate_to_last(v);
            return Vec<T>(last.y, last.x, last.z);
        };
        const Vec<T> d = rotate(ray.direction), o = rotate(ray.origin);
        const T sz = named("Sz", T(1) / d.z), sx = named("Sx", d.x * sz), sy = named("Sy", d.y * sz);
        const auto shear = [&](const Vec<T>& vertex) {
            const Vec<T> v = rotate(vertex) - o;
            return Vec<T>(v.x - v.z * sx, v.y - v.z * sy, v.z);
        };
        const Vec<T> a = shear(triangle.a), b = shear(triangle.b), c = shear(triangle.c);

        // The edge tests of the sheared triangle, whose ray runs along z.
        const T u = named("U", c.x * b.y - c.y * b.x), v = named("V", a.x * c.y - a.y * c.x);
        const T w = named("W", b.x * a.y - b.y * a.x), zero(0);
        const T det = named("det", u + v + w);
        const T tn = named("T", u * (sz * a.z) + v * (sz * b.z) + w * (sz * c.z));
        const T inverse = named("1/det", T(1) / det), t = named("t", tn * inverse);
        named("u", u * inverse);
        named("v", v * inverse);

        const mask_t<T> is_inside = (u >= zero && v >= zero && w >= zero) || (u <= zero && v <= zero && w <= zero);
        return single_hit<T>(is_inside && is_not_zero(det) && zero < t, t);
    }
};

}  // namespace lostbits::intersect::triangle
