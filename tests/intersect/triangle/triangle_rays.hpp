// Rays at triangles, in distributions that each test one thing, and the exact answer in fractions: the plane first,
// then coordinates by Gram's determinants. No form and no truth computes it like this.
#pragma once

#include <array>

#include "intersect/exact.hpp"
#include "intersect/info.hpp"
#include "measure/seeded.hpp"
#include "shapes/triangle/triangle.hpp"

namespace lostbits::test {

struct TriangleSample {
    Ray<double> ray;
    Triangle<double> triangle;
};

using RationalVec = std::array<Rational, 3>;

inline RationalVec exactly(const Vec<double>& v) { return {Rational(v.x), Rational(v.y), Rational(v.z)}; }
inline RationalVec minus(const RationalVec& a, const RationalVec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// True answer for the line, and for the ray from its origin on.
struct TriangleAnswer {
    bool crosses = false;  ///< the plane; all that follows only then
    bool front = false;    ///< from the side from which a, b, c run counter-clockwise
    Rational t, u, v, w;   ///< the point is u a + v b + w c

    [[nodiscard]] bool meets() const { return crosses && t >= 0 && u >= 0 && v >= 0 && w >= 0; }
    [[nodiscard]] bool meets(intersect::Facing facing) const {
        return meets() && (facing == intersect::Facing::both || front == (facing == intersect::Facing::front));
    }
    [[nodiscard]] bool on_rim() const { return u == 0 || v == 0 || w == 0; }
    /// Distance of the nearest decision from equality.
    [[nodiscard]] Rational slack() const {
        Rational least = abs(t);
        for (const Rational& x : {u, v, w}) least = abs(x) < least ? abs(x) : least;
        return least;
    }
};

inline TriangleAnswer answer_of(const TriangleSample& sample) {
    const RationalVec o = exactly(sample.ray.origin), d = exactly(sample.ray.direction), a = exactly(sample.triangle.a);
    const RationalVec p = minus(exactly(sample.triangle.b), a), q = minus(exactly(sample.triangle.c), a);
    const RationalVec n{p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    TriangleAnswer answer;
    const Rational across = dot(n, d);
    answer.crosses = across != 0;
    answer.front = across < 0;
    if (!answer.crosses) return answer;
    answer.t = dot(n, minus(a, o)) / across;
    const RationalVec from{o[0] + answer.t * d[0] - a[0], o[1] + answer.t * d[1] - a[1], o[2] + answer.t * d[2] - a[2]};
    const Rational pp = dot(p, p), pq = dot(p, q), qq = dot(q, q), fp = dot(from, p), fq = dot(from, q);
    const Rational gram = pp * qq - pq * pq;
    answer.v = (fp * qq - fq * pq) / gram;
    answer.w = (fq * pp - fp * pq) / gram;
    answer.u = 1 - answer.v - answer.w;
    return answer;
}

/// Whole numbers.
inline Vec<double> whole_vec(Seeded& rng, int size) {
    const auto one = [&] { return static_cast<double>(rng.integer(-size, size)); };
    const double x = one(), y = one(), z = one();
    return {x, y, z};
}

/// A triangle of whole numbers with an area, and a direction that is not zero.
inline TriangleSample whole_sample(Seeded& rng, int size) {
    TriangleSample s;
    do {
        s = {{whole_vec(rng, size), whole_vec(rng, size)}, {whole_vec(rng, size), {}, {}}};
        s.triangle.b = whole_vec(rng, size);
        s.triangle.c = whole_vec(rng, size);
    } while (are_on_one_line(s.triangle.a, s.triangle.b, s.triangle.c) || s.ray.direction == Vec<double>(0, 0, 0));
    return s;
}

/// The ray rotated so that it meets the point at t = `steps`, exactly, for whole numbers.
inline void aim(TriangleSample& sample, const Vec<double>& point, double steps) {
    sample.ray.origin = point - steps * sample.ray.direction;
}

struct TriangleDistribution {
    const char* name;
    TriangleSample (*draw)(Seeded&);
};

inline const TriangleDistribution triangle_distributions[] = {
    {"random",
     [](Seeded& rng) {
         TriangleSample s{{rng.vec(-1, 1), {}}, {}};
         s.triangle.a = rng.vec(-1, 1), s.triangle.b = rng.vec(-1, 1), s.triangle.c = rng.vec(-1, 1);
         const double u = rng.uniform(-0.2, 1.2), v = rng.uniform(-0.2, 1.2) * (1 - u);
         s.ray.direction = u * s.triangle.a + v * s.triangle.b + (1 - u - v) * s.triangle.c - s.ray.origin;
         return s;
     }},
    {"through an edge",
     [](Seeded& rng) {
         TriangleSample s = whole_sample(rng, 1000);
         s.triangle.b = s.triangle.a + 8.0 * whole_vec(rng, 100);
         const auto part = static_cast<double>(rng.integer(1, 7)) / 8;
         aim(s, s.triangle.a + part * (s.triangle.b - s.triangle.a), static_cast<double>(rng.integer(1, 50)));
         return s;
     }},
    {"through a vertex",
     [](Seeded& rng) {
         TriangleSample s = whole_sample(rng, 1000);
         const Vec<double>* const vertices[] = {&s.triangle.a, &s.triangle.b, &s.triangle.c};
         aim(s, *vertices[rng.index(3)], static_cast<double>(rng.integer(-2, 50)));
         return s;
     }},
    {"in the plane",
     [](Seeded& rng) {
         TriangleSample s = whole_sample(rng, 100);
         const Vec<double> p = s.triangle.b - s.triangle.a, q = s.triangle.c - s.triangle.a;
         const auto some = [&] { return static_cast<double>(rng.integer(-5, 5)); };
         const double i = some(), j = some(), k = some(), l = some();
         s.ray = {s.triangle.a + i * p + j * q, k * p + (l == 0 && k == 0 ? 1.0 : l) * q};
         return s;
     }},
    {"from the triangle",
     [](Seeded& rng) {
         TriangleSample s = whole_sample(rng, 100);
         s.triangle.b = s.triangle.a + 8.0 * whole_vec(rng, 20), s.triangle.c = s.triangle.a + 8.0 * whole_vec(rng, 20);
         const auto i = static_cast<double>(rng.integer(0, 8)), j = static_cast<double>(rng.integer(0, 8));
         s.ray.origin = s.triangle.a + i / 8 * (s.triangle.b - s.triangle.a) + j / 8 * (s.triangle.c - s.triangle.a);
         return s;
     }},
    {"a needle",
     [](Seeded& rng) {
         TriangleSample s = whole_sample(rng, 1000);
         const Vec<double> middle = 0.5 * (s.triangle.a + s.triangle.b);
         s.triangle.c = middle + 0x1p-20 * whole_vec(rng, 9);
         aim(s, s.triangle.a + 0.25 * (s.triangle.c - s.triangle.a), static_cast<double>(rng.integer(1, 50)));
         return s;
     }},
    {"edge-on by a last place",
     [](Seeded& rng) {
         TriangleSample s = whole_sample(rng, 100);
         s.triangle.b = s.triangle.a + 64.0 * whole_vec(rng, 20),
         s.triangle.c = s.triangle.a + 64.0 * whole_vec(rng, 20);
         const auto some = [&](int most) { return static_cast<double>(rng.integer(1, most)); };
         const Vec<double> along = some(9) * (s.triangle.b - s.triangle.a) + some(9) * (s.triangle.c - s.triangle.a);
         s.ray.direction = along + 0x1p-9 * whole_vec(rng, 1);
         aim(s, s.triangle.a + 0.25 * (s.triangle.b - s.triangle.a) + 0.5 * (s.triangle.c - s.triangle.a), some(3));
         return s;
     }},
    {"far away",
     [](Seeded& rng) {
         TriangleSample s = whole_sample(rng, 4);
         aim(s, s.triangle.a + rng.unit() * (s.triangle.b - s.triangle.a), 0x1p20);
         return s;
     }},
    {"subnormal",
     [](Seeded& rng) {
         TriangleSample s = whole_sample(rng, 40);
         aim(s, whole_vec(rng, 2) + s.triangle.a, 3);
         for (Vec<double>* const p : {&s.ray.origin, &s.triangle.a, &s.triangle.b, &s.triangle.c}) *p = 0x1p-149 * *p;
         return s;
     }},
    {"huge",
     [](Seeded& rng) {
         TriangleSample s = whole_sample(rng, 1000);
         const Vec<double> middle = 0.25 * (s.triangle.a + s.triangle.b) + 0.5 * s.triangle.c;
         aim(s, middle, 3);
         for (Vec<double>* const p : {&s.ray.origin, &s.triangle.a, &s.triangle.b, &s.triangle.c}) *p = 0x1p110 * *p;
         return s;
     }},
};

/// Every number rounded to binary32: those of constructed rays are short, and stay.
inline TriangleSample in_floats(TriangleSample s) {
    for (Vec<double>* const p : {&s.ray.origin, &s.ray.direction, &s.triangle.a, &s.triangle.b, &s.triangle.c})
        *p = test::stored(*p, binary32);
    return s;
}

/// Calls `visit(distribution, sample)` this many times for each distribution; samples without area or direction are
/// left out.
template <class Visit>
void for_each_triangle(int each, const Visit& visit) {
    for (const TriangleDistribution& distribution : triangle_distributions) {
        Seeded rng(0x7a1);
        for (int i = 0; i < each; ++i) {
            const TriangleSample s = in_floats(distribution.draw(rng));
            if (are_on_one_line(s.triangle.a, s.triangle.b, s.triangle.c) || s.ray.direction == Vec<double>(0, 0, 0))
                continue;
            visit(distribution, s);
        }
    }
}

}  // namespace lostbits::test
