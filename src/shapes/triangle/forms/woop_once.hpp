// Woop's test with exact signs of edges and a rule for ties: only one of the triangles around an edge or a vertex
// claims a line through it. docs/cracks.md has the proof.
#pragma once

#include "shapes/triangle/forms/woop_pbrt.hpp"

namespace lostbits::intersect::triangle {

struct WoopOnce {
    static constexpr Info info{
        .name = "triangle.woop_once",
        .title = "Woop's test, exact edges, ties to one triangle",
        .source = "Woop, Benthin and Wald, JCGT 2(1), 2013; ties: Edelsbrunner and Mücke, ACM TOG 9(1), 1990",
        .roots = Roots::first_only,
        .at_origin = AtOrigin::miss,
        .weights = {"b0", "b1", "b2"},
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Triangle<T>& triangle) {
        using W = typename Wider<T>::type;
        const auto wide = Wider<T>::widen;
        const auto narrow = Wider<T>::narrow;
        const WoopVertices<T> v(ray, triangle);
        const PlanePoint<W> p0(wide(v.p0.x), wide(v.p0.y)), p1(wide(v.p1.x), wide(v.p1.y)),
            p2(wide(v.p2.x), wide(v.p2.y));
        const OrientedEdge<W> a(p1, p2), b(p2, p0), c(p0, p1);
        const W det = a.value + b.value + c.value;
        const W scaled_t = a.value * wide(v.p0.z) + b.value * wide(v.p1.z) + c.value * wide(v.p2.z);
        const T t = named("t", narrow(scaled_t / det));
        named("b0", narrow(a.value / det));
        named("b1", narrow(b.value / det));
        named("b2", narrow(c.value / det));
        const mask_t<W> has_one_sign =
            (a.is_left && b.is_left && c.is_left) || (a.is_right && b.is_right && c.is_right);
        const mask_t<T> is_inside = has_one_sign;
        return single_hit<T>(is_inside && T(0) < t, t);
    }

private:
    template <Number W>
    struct PlanePoint {
        W x, y;
        PlanePoint(const W& px, const W& py) : x(px), y(py) {}
    };

    /// An edge from p to q, and the side of it on which the origin lies. `value` is p × q by Kahan's difference of
    /// products. If no product overflows and no error of a product underflows, the error is less than two units in the
    /// last place, so the sign is exact, and the value is 0 only if p × q is 0 (Jeannerod, Louvet and Muller,
    /// Mathematics of Computation 82, 2013). If the value is 0, the origin is treated as (ε, ε²), and its side is the
    /// sign of ε (p.y − q.y) + ε² (q.x − p.x).
    template <Number W>
    struct OrientedEdge {
        W value;
        mask_t<W> is_left, is_right;

        OrientedEdge(const PlanePoint<W>& p, const PlanePoint<W>& q)
            : value(cross_of(p, q)),
              is_left(value > W(0) || (!(value < W(0)) && (p.y > q.y || (!(p.y < q.y) && q.x > p.x)))),
              is_right(value < W(0) || (!(value > W(0)) && (p.y < q.y || (!(p.y > q.y) && q.x < p.x)))) {}

    private:
        static W cross_of(const PlanePoint<W>& p, const PlanePoint<W>& q) {
            const W yx = p.y * q.x;
            return fma(p.x, q.y, -yx) + fma(-p.y, q.x, yx);
        }
    };
};

}  // namespace lostbits::intersect::triangle
