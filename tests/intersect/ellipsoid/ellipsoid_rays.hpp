// Rays at ellipsoids, in families that each do one thing, and the exact answer in fractions: the quadratic divided by
// the squares of the radii, which no span and no form computes.
#pragma once

#include "intersect/exact.hpp"
#include "intersect/sampled_rays.hpp"
#include "shapes/ellipsoid/ellipsoid.hpp"

namespace lostbits::test {

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

inline EllipsoidAnswer answer_of(const Sample<Ellipsoid>& s) {
    EllipsoidAnswer answer;
    for (int i = 0; i < 3; ++i) {
        const Rational f = Rational(s.ray.origin[i]) - Rational(s.solid.centre[i]), d(s.ray.direction[i]);
        const Rational r2 = Rational(s.solid.radii[i]) * Rational(s.solid.radii[i]);
        answer.a += d * d / r2;
        answer.h += f * d / r2;
        answer.c += f * f / r2;
    }
    answer.c -= 1;
    return answer;
}

/// Whole radii and centres, and a ray along an axis that passes the centre by a whole part of the radii: with
/// (3/5)² + (4/5)² = 1 it touches.
inline Sample<Ellipsoid> whole_ellipsoid(Seeded& rng) {
    const auto whole = [&](int low, int high) { return static_cast<double>(rng.integer(low, high)); };
    const double x = whole(-50, 50), y = whole(-50, 50), z = whole(-50, 50);
    const double p = 5 * whole(1, 20), q = 5 * whole(1, 20), r = 5 * whole(1, 20);
    return {{{0, 0, 0}, {0, 0, 0}}, {{x, y, z}, {p, q, r}}};
}

inline const SampledRays<Ellipsoid> ellipsoid_rays[] = {
    {"random",
     [](Seeded& rng) {
         Sample<Ellipsoid> s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(0.1, 2)}};
         const Vec<double> u = rng.vec(-1.2, 1.2);
         s.ray.direction = s.solid.centre + u * s.solid.radii - s.ray.origin;
         return s;
     }},
    {"tangent",
     [](Seeded& rng) {
         Sample<Ellipsoid> s = whole_ellipsoid(rng);
         const auto& [g, r] = s.solid;
         s.ray = {{g.x + 0.6 * r.x, g.y + 0.8 * r.y, g.z + static_cast<double>(rng.integer(-400, 400))},
                  {0, 0, rng.sign()}};
         return s;
     }},
    {"from the surface",
     [](Seeded& rng) {
         Sample<Ellipsoid> s = whole_ellipsoid(rng);
         const auto& [g, r] = s.solid;
         s.ray = {{g.x + rng.sign() * 0.6 * r.x, g.y + rng.sign() * 0.8 * r.y, g.z}, rng.vec(-1, 1)};
         return s;
     }},
    {"from inside",
     [](Seeded& rng) {
         Sample<Ellipsoid> s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(0.1, 2)}};
         s.ray.origin = s.solid.centre + rng.vec(-0.5, 0.5) * s.solid.radii;
         return s;
     }},
    {"grazing",
     [](Seeded& rng) {
         Sample<Ellipsoid> s = whole_ellipsoid(rng);
         const auto& [g, r] = s.solid;
         const double x = g.x + 0.6 * r.x, y = g.y + 0.8 * r.y;
         const auto near = [&](double v) { return v + static_cast<double>(rng.integer(-3, 3)) * v * 0x1p-22; };
         s.ray = {{near(x), near(y), g.z - 300}, {0, 0, 1}};
         return s;
     }},
    {"thin",
     [](Seeded& rng) {
         Sample<Ellipsoid> s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(0.5, 2)}};
         s.solid.radii.z *= 0x1p-20;
         const Vec<double> u = rng.vec(-1.1, 1.1);
         s.ray.direction = s.solid.centre + u * s.solid.radii - s.ray.origin;
         return s;
     }},
    {"far away",
     [](Seeded& rng) {
         Sample<Ellipsoid> s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(0.1, 2)}};
         s.ray.origin = s.solid.centre + rng.vec(-1, 1) * s.solid.radii - 0x1p20 * s.ray.direction;
         return s;
     }},
    {"tiny", [](Seeded& rng) { return scaled_from_below(whole_ellipsoid(rng), 0x1p-140); }},
    {"huge", [](Seeded& rng) { return scaled_from_below(whole_ellipsoid(rng), 0x1p110); }},
};

inline const ForEachSample for_each_ellipsoid{ellipsoid_rays, 0x7a2};

}  // namespace lostbits::test
