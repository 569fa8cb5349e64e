// Rays at ellipsoids, in families that each do one thing, and the exact answer in fractions: the quadratic divided by
// the squares of the radii, which no span and no form computes.
#pragma once

#include "intersect/exact.hpp"
#include "measure/seeded.hpp"
#include "shapes/ellipsoid/ellipsoid.hpp"

namespace lostbits::test {

using testing::Seeded;

struct EllipsoidSample {
    Ray<double> ray;
    Ellipsoid<double> ellipsoid;
};

/// P(t) = a t² + 2 h t + c of the line, and what follows for the ray from its origin on.
struct EllipsoidAnswer {
    Rational a = 0, h = 0, c = 0;

    [[nodiscard]] Rational at(const Rational& t) const { return (a * t + 2 * h) * t + c; }
    [[nodiscard]] Rational discriminant() const { return h * h - a * c; }
    [[nodiscard]] bool meets() const { return c <= 0 || (h < 0 && discriminant() >= 0); }
    [[nodiscard]] bool touches() const { return discriminant() == 0 && (c > 0 || c == 0); }
    /// Whether t, of which an answer is known to be at most `e` off, may be the first that is not before the origin:
    /// P changes its sign around it, downwards where the ray comes from outside and upwards from inside.
    [[nodiscard]] bool is_first(const Rational& t, const Rational& e) const {
        if (discriminant() == 0) return abs(Rational(t + h / a)) <= e;
        const Rational before = at(t - e), after = at(t + e);
        if (c > 0) return before >= 0 && after <= 0;
        return before <= 0 && after >= 0;
    }
    /// How far the nearest decision is from an equality, in units of the numbers that it is made of.
    [[nodiscard]] bool is_clear() const {
        return abs(discriminant()) * 1024 > abs(a * c) && abs(c) * 1024 > 1 && abs(h) * abs(h) * 1024 > a;
    }
};

inline EllipsoidAnswer answer_of(const EllipsoidSample& s) {
    EllipsoidAnswer answer;
    for (int i = 0; i < 3; ++i) {
        const Rational f = Rational(s.ray.origin[i]) - Rational(s.ellipsoid.centre[i]), d(s.ray.direction[i]);
        const Rational r2 = Rational(s.ellipsoid.radii[i]) * Rational(s.ellipsoid.radii[i]);
        answer.a += d * d / r2;
        answer.h += f * d / r2;
        answer.c += f * f / r2;
    }
    answer.c -= 1;
    return answer;
}

struct EllipsoidRays {
    const char* name;
    EllipsoidSample (*make)(Seeded&);
};

/// Whole radii and centres, and a ray along an axis that passes the centre by a whole part of the radii: with
/// (3/5)² + (4/5)² = 1 it touches.
inline EllipsoidSample whole_ellipsoid(Seeded& rng) {
    const auto whole = [&](int low, int high) { return static_cast<double>(rng.integer(low, high)); };
    const double x = whole(-50, 50), y = whole(-50, 50), z = whole(-50, 50);
    const double p = 5 * whole(1, 20), q = 5 * whole(1, 20), r = 5 * whole(1, 20);
    return {{{0, 0, 0}, {0, 0, 0}}, {{x, y, z}, {p, q, r}}};
}

inline const EllipsoidRays ellipsoid_rays[] = {
    {"random",
     [](Seeded& rng) {
         EllipsoidSample s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(0.1, 2)}};
         const Vec<double> u = rng.vec(-1.2, 1.2);
         s.ray.direction = s.ellipsoid.centre + u * s.ellipsoid.radii - s.ray.origin;
         return s;
     }},
    {"tangent",
     [](Seeded& rng) {
         EllipsoidSample s = whole_ellipsoid(rng);
         const auto& [g, r] = s.ellipsoid;
         s.ray = {{g.x + 0.6 * r.x, g.y + 0.8 * r.y, g.z + static_cast<double>(rng.integer(-400, 400))},
                  {0, 0, rng.sign()}};
         return s;
     }},
    {"from the surface",
     [](Seeded& rng) {
         EllipsoidSample s = whole_ellipsoid(rng);
         const auto& [g, r] = s.ellipsoid;
         s.ray = {{g.x + rng.sign() * 0.6 * r.x, g.y + rng.sign() * 0.8 * r.y, g.z}, rng.vec(-1, 1)};
         return s;
     }},
    {"from inside",
     [](Seeded& rng) {
         EllipsoidSample s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(0.1, 2)}};
         s.ray.origin = s.ellipsoid.centre + rng.vec(-0.5, 0.5) * s.ellipsoid.radii;
         return s;
     }},
    {"grazing",
     [](Seeded& rng) {
         EllipsoidSample s = whole_ellipsoid(rng);
         const auto& [g, r] = s.ellipsoid;
         const double x = g.x + 0.6 * r.x, y = g.y + 0.8 * r.y;
         const auto near = [&](double v) { return v + static_cast<double>(rng.integer(-3, 3)) * v * 0x1p-22; };
         s.ray = {{near(x), near(y), g.z - 300}, {0, 0, 1}};
         return s;
     }},
    {"thin",
     [](Seeded& rng) {
         EllipsoidSample s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(0.5, 2)}};
         s.ellipsoid.radii.z *= 0x1p-20;
         const Vec<double> u = rng.vec(-1.1, 1.1);
         s.ray.direction = s.ellipsoid.centre + u * s.ellipsoid.radii - s.ray.origin;
         return s;
     }},
    {"far away",
     [](Seeded& rng) {
         EllipsoidSample s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(0.1, 2)}};
         s.ray.origin = s.ellipsoid.centre + rng.vec(-1, 1) * s.ellipsoid.radii - 0x1p20 * s.ray.direction;
         return s;
     }},
    {"tiny",
     [](Seeded& rng) {
         EllipsoidSample s = whole_ellipsoid(rng);
         s.ray = {s.ellipsoid.centre + Vec<double>(7, 11, -300), Vec<double>(0.25, -0.5, 16)};
         s.ray.origin = 0x1p-140 * s.ray.origin;
         s.ellipsoid = {0x1p-140 * s.ellipsoid.centre, 0x1p-140 * s.ellipsoid.radii};
         return s;
     }},
    {"huge",
     [](Seeded& rng) {
         EllipsoidSample s = whole_ellipsoid(rng);
         s.ray = {s.ellipsoid.centre + Vec<double>(7, 11, -300), Vec<double>(0.25, -0.5, 16)};
         s.ray.origin = 0x1p110 * s.ray.origin;
         s.ellipsoid = {0x1p110 * s.ellipsoid.centre, 0x1p110 * s.ellipsoid.radii};
         return s;
     }},
};

/// Every number rounded to binary32: those of constructed rays are short, and stay.
inline EllipsoidSample in_floats(EllipsoidSample s) {
    for (Vec<double>* const p : {&s.ray.origin, &s.ray.direction, &s.ellipsoid.centre, &s.ellipsoid.radii})
        *p = testing::stored(*p, binary32);
    return s;
}

/// `visit(family, sample)` of each family so many times.
template <class Visit>
void for_each_ellipsoid(int each, const Visit& visit) {
    for (const EllipsoidRays& family : ellipsoid_rays) {
        Seeded rng(0x7a2);
        for (int i = 0; i < each; ++i) {
            const EllipsoidSample s = in_floats(family.make(rng));
            if (s.ray.direction == Vec<double>(0, 0, 0)) continue;
            visit(family, s);
        }
    }
}

}  // namespace lostbits::test
