// Where a ray meets a solid under a matrix, in fractions that know no adjugate matrix: Gauss's elimination takes the
// ray back, and every decision is a comparison there.
#pragma once

#include <array>
#include <cstdlib>
#include <optional>
#include <utility>

#include "intersect/exact.hpp"
#include "measure/truth/truth.hpp"
#include "shapes/solid.hpp"

namespace lostbits::testing::placed {

using measure::truth::Certified;
using measure::truth::Truth;
using test::Rational;

using Point = std::array<Rational, 3>;

inline Rational dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Point exact(const Vec<double>& v) { return {Rational(v.x), Rational(v.y), Rational(v.z)}; }

/// x with A x = v, A's rows in the first three columns of the matrix.
inline Point solved(const std::array<double, 12>& m, Point v) {
    std::array<std::array<Rational, 4>, 3> rows;
    for (std::size_t i = 0; i < 3; ++i)
        rows[i] = {Rational(m[4 * i]), Rational(m[4 * i + 1]), Rational(m[4 * i + 2]), v[i]};
    for (std::size_t k = 0; k < 3; ++k) {
        std::size_t pivot = k;
        while (rows[pivot][k] == 0) ++pivot;
        std::swap(rows[k], rows[pivot]);
        for (std::size_t i = 0; i < 3; ++i) {
            if (i == k) continue;
            const Rational factor = rows[i][k] / rows[k][k];
            for (std::size_t j = k; j < 4; ++j) rows[i][j] -= factor * rows[k][j];
        }
    }
    return {rows[0][3] / rows[0][0], rows[1][3] / rows[1][1], rows[2][3] / rows[2][2]};
}

/// The ray in the space of the solid.
struct Line {
    Point o, d;

    Line(const Ray<double>& ray, const Placement<double>& placed) {
        const auto& m = placed.matrix;
        const Point shift{Rational(m[3]), Rational(m[7]), Rational(m[11])};
        if (placed.is_inverse) {
            for (std::size_t i = 0; i < 3; ++i) {
                const Point row{Rational(m[4 * i]), Rational(m[4 * i + 1]), Rational(m[4 * i + 2])};
                o[i] = dot(row, exact(ray.origin)) + shift[i];
                d[i] = dot(row, exact(ray.direction));
            }
            return;
        }
        o = solved(m, exact(ray.origin) - shift);
        d = solved(m, exact(ray.direction));
    }
};

inline Rational low(const Certified& x) { return (Rational(x.hi) + Rational(x.lo) - Rational(x.bound)); }
inline Rational high(const Certified& x) { return (Rational(x.hi) + Rational(x.lo) + Rational(x.bound)); }
inline Rational power(std::int64_t e) {
    Rational two(1);
    for (std::int64_t k = 0; k < std::abs(e); ++k) two *= 2;
    return e < 0 ? Rational(1) / two : two;
}

/// Whether truth and fractions agree.
inline bool agrees(const Line& line, const Sphere<double>& sphere, const Truth& truth) {
    const Point f = line.o - exact(sphere.centre);
    const Rational a = dot(line.d, line.d), h = dot(f, line.d), c = dot(f, f) - Rational(sphere.radius) * sphere.radius;
    const Rational q = h * h - a * c;
    const bool hit = c <= 0 || (h < 0 && q >= 0);
    if (truth.decision != (hit ? Truth::Decision::hit : Truth::Decision::miss)) return false;
    if (!hit) return true;
    const Rational unit = truth.t.is_zero() ? Rational(1) : power(truth.t.exponent);
    const Rational from = low(truth.t) * unit, to = high(truth.t) * unit;
    if (c == 0) return from == 0 && to == 0;
    const auto value = [&](const Rational& t) { return Rational((a * t + 2 * h) * t + c); };
    const auto slope = [&](const Rational& t) { return Rational(a * t + h); };
    if (c < 0) return value(from) <= 0 && value(to) >= 0 && slope(to) >= 0;
    if (q == 0) return slope(from) <= 0 && slope(to) >= 0;
    return value(from) >= 0 && slope(from) <= 0 && (value(to) <= 0);
}

inline bool agrees(const Line& line, const Box<double>& box, const Truth& truth) {
    std::optional<Rational> enter, leave;
    bool crossed = true;
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Rational lo(box.lo[i]), hi(box.hi[i]);
        if (line.d[k] == 0) {
            crossed = crossed && lo <= line.o[k] && line.o[k] <= hi;
            continue;
        }
        Rational in = (lo - line.o[k]) / line.d[k], out = (hi - line.o[k]) / line.d[k];
        if (in > out) std::swap(in, out);
        if (!enter || in > *enter) enter = in;
        if (!leave || out < *leave) leave = out;
    }
    const bool hit = crossed && *enter <= *leave && *leave >= 0;
    if (truth.decision != (hit ? Truth::Decision::hit : Truth::Decision::miss)) return false;
    if (!hit) return true;
    const Rational unit = truth.t.is_zero() ? Rational(1) : power(truth.t.exponent);
    const Rational t = *enter > 0 ? *enter : Rational(0);
    return low(truth.t) * unit <= t && t <= high(truth.t) * unit;
}

/// By the point in the plane of the triangle, a + u (b − a) + v (c − a). A line along the plane is not
/// judged.
inline bool agrees(const Line& line, const Triangle<double>& triangle, const Truth& truth) {
    const Point a = exact(triangle.a), b = exact(triangle.b) - a, c = exact(triangle.c) - a, s = line.o - a;
    const auto cross = [](const Point& x, const Point& y) {
        return Point{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
    };
    const Point n = cross(b, c);
    const Rational det = -dot(line.d, n);
    if (det == 0) return true;
    const Rational t = dot(s, n) / det;
    const Point p{s[0] + t * line.d[0], s[1] + t * line.d[1], s[2] + t * line.d[2]};
    const Rational bb = dot(b, b), bc = dot(b, c), cc = dot(c, c), pb = dot(p, b), pc = dot(p, c),
                   g = bb * cc - bc * bc;
    const Rational along_b = (pb * cc - pc * bc) / g, along_c = (pc * bb - pb * bc) / g;
    const bool hit = t >= 0 && along_b >= 0 && along_c >= 0 && along_b + along_c <= 1;
    if (truth.decision != (hit ? Truth::Decision::hit : Truth::Decision::miss)) return false;
    if (!hit) return true;
    const Rational unit = truth.t.is_zero() ? Rational(1) : power(truth.t.exponent);
    return low(truth.t) * unit <= t && t <= high(truth.t) * unit;
}

}  // namespace lostbits::testing::placed
