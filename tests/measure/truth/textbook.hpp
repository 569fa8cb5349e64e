// Spheres, boxes and triangles by the textbook, in numbers of 2048 bits: an independent computation of how a small
// change of a problem changes its answer.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "number/real.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::test::textbook {

using Wide = BasicReal<2048>;
constexpr std::size_t most_of_problem = 15;

/// The numbers of a problem: origin, direction, primitive.
template <class N>
using NumbersOf = std::array<N, most_of_problem>;
using Numbers = NumbersOf<Wide>;

template <class N>
Vec<N> point(const NumbersOf<N>& x, std::size_t i) {
    return {x[i], x[i + 1], x[i + 2]};
}

template <class N>
struct Quadratic {
    N a, h, c;
    explicit Quadratic(const NumbersOf<N>& x) {
        const Vec<N> f = point(x, 0) - point(x, 6), d = point(x, 3);
        a = dot(d, d), h = dot(f, d), c = dot(f, f) - x[9] * x[9];
    }
    [[nodiscard]] N discriminant() const { return h * h - a * c; }
    [[nodiscard]] std::optional<N> root(int side) const {
        const N q = discriminant();
        if (q < 0) return std::nullopt;
        const N root = sqrt(q);
        return N((side < 0 ? N(-h - root) : N(-h + root)) / a);
    }
};

/// Line and the plane through three points: their intersection, the sides of the edges on which it lies, and t = n/det.
template <class N>
struct Crossing {
    N u, v, w, det, n;
    explicit Crossing(const NumbersOf<N>& x) {
        const Vec<N> d = point(x, 3), a = point(x, 6) - point(x, 0), b = point(x, 9) - point(x, 0),
                     c = point(x, 12) - point(x, 0);
        const Vec<N> bc = cross(b, c);
        u = dot(d, bc), v = dot(d, cross(c, a)), w = dot(d, cross(a, b)), det = u + v + w, n = dot(a, bc);
    }
    [[nodiscard]] bool is_inside() const {
        return det > 0 ? u >= 0 && v >= 0 && w >= 0 : det < 0 && u <= 0 && v <= 0 && w <= 0;
    }
};

/// A shape by the textbook: the t of a root or a face if the line meets it, and a residual that is 0 there.
struct Textbook {
    int which = 0;                     ///< of a sphere −1 and 1: the near root and the far one
    std::array<bool, 3> crossed = {};  ///< of a box: the axes along which the ray moves

    [[nodiscard]] std::optional<Wide> t(Shape shape, const Numbers& x) const {
        if (shape == Shape::sphere) return Quadratic(x).root(which);
        if (shape == Shape::box) return entry(x);
        return through_triangle(x);
    }
    static std::optional<Wide> through_triangle(const Numbers& x) {
        const Crossing p(x);
        return p.is_inside() ? std::optional(Wide(p.n / p.det)) : std::nullopt;
    }
    /// The last of the entries, if no exit comes before it and if it belongs to a face that is crossed.
    [[nodiscard]] std::optional<Wide> entry(const Numbers& x) const {
        bool same = true;
        std::optional<Wide> last, first;
        for (std::size_t k = 0; k < 3; ++k) {
            const Wide &o = x[k], &d = x[3 + k], &lo = x[6 + k], &hi = x[9 + k];
            if (d == 0) {
                if (o < lo || o > hi) return std::nullopt;
                continue;
            }
            Wide in = (lo - o) / d, out = (hi - o) / d;
            if (d < 0) std::swap(in, out);
            if (!last || in > *last) last = in, same = crossed[k];
            if (!first || out < *first) first = out;
        }
        return last && *last <= *first && same ? last : std::nullopt;
    }
};

/// P(t) of a sphere, otherwise n − t m of the face: the residual that changes with t.
template <class N>
N residual(Shape shape, const NumbersOf<N>& x, const N& t, std::size_t axis) {
    if (shape == Shape::sphere) {
        const Quadratic p(x);
        return (p.a * t + 2 * p.h) * t + p.c;
    }
    if (shape == Shape::box) {
        const N& plane = x[3 + axis] < 0 ? x[9 + axis] : x[6 + axis];
        return plane - x[axis] - t * x[3 + axis];
    }
    const Vec<N> n = cross(Vec<N>(point(x, 9) - point(x, 6)), Vec<N>(point(x, 12) - point(x, 6)));
    return dot(Vec<N>(point(x, 6) - point(x, 0)), n) - t * dot(point(x, 3), n);
}

/// The numbers of a ray and of a primitive.
template <class N = Wide>
NumbersOf<N> numbers_of(const Ray<double>& ray, const Primitive<double>& primitive) {
    NumbersOf<N> x;
    for (std::size_t k = 0; k < 3; ++k)
        x[k] = ray.origin[static_cast<int>(k)], x[3 + k] = ray.direction[static_cast<int>(k)];
    for (std::size_t k = 6; k < 6 + primitive.shape_numbers().size(); ++k) x[k] = primitive.numbers[k - 6];
    return x;
}

}  // namespace lostbits::test::textbook
