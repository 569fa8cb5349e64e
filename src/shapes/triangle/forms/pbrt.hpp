// pbrt's triangle: Woop's test with Kahan's differences of products. A hit whose t is no more than its error bound is a
// miss.
#pragma once

#include "geometry/rounding_bound.hpp"
#include "shapes/triangle/forms/woop_pbrt.hpp"

namespace lostbits::intersect::triangle {

struct Pbrt {
    static constexpr Info info{
        .name = "triangle.pbrt",
        .title = "Woop's test, Kahan's products, t above its error bound",
        .source = "pbrt-v4, src/pbrt/shapes.cpp:168, t <= deltaT at 245; exact arithmetic has no bound",
        .roots = Roots::first_only,
        .at_origin = AtOrigin::miss,
        .weights = {"b0", "b1", "b2"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        const WoopVertices<T> v(ray, triangle);
        const WoopEdges<T> e(v, [](const T& a, const T& b, const T& c, const T& d) {
            const T cd = c * d, difference = fma(a, b, -cd), error = fma(-c, d, cd);
            return T(difference + error);
        });
        const WoopHit<T> woop_hit = hit_from_edges(triangle, v, e);
        return single_hit<T>(woop_hit.hit && !(woop_hit.t <= error_of_t(v, e, woop_hit.inverse_determinant)),
                             woop_hit.t);
    }

private:
    template <Number T>
    static T error_of_t(const WoopVertices<T>& v, const WoopEdges<T>& e, const T& inverse_determinant) {
        const auto largest_size = [](const T& a, const T& b, const T& c) { return max(max(abs(a), abs(b)), abs(c)); };
        const T x = largest_size(v.p0.x, v.p1.x, v.p2.x), y = largest_size(v.p0.y, v.p1.y, v.p2.y),
                z = largest_size(v.p0.z, v.p1.z, v.p2.z);
        const T g2 = gamma_bound<T>(2), g3 = gamma_bound<T>(3), g5 = gamma_bound<T>(5);
        const T dz = g3 * z, dx = g5 * (x + z), dy = g5 * (y + z);
        const T de = T(2) * (g2 * x * y + dy * x + dx * y), edge = largest_size(e.e0, e.e1, e.e2);
        return named("deltaT", T(3) * (g3 * edge * z + de * z + dz * edge) * abs(inverse_determinant));
    }
};

}  // namespace lostbits::intersect::triangle
