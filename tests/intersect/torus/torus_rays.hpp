// Rays at tori, in families that each do one thing.
#pragma once

#include "intersect/sampled_rays.hpp"
#include "intersect/torus/torus_answer.hpp"

namespace lostbits::test {

inline ClearTorusAnswer answer_of(const Sample<Torus>& s) { return {s.ray, s.solid}; }

/// Around z, of whole numbers; the radii are multiples of 25, so that 3, 4 and 5 give points and tangents.
inline Sample<Torus> upright_torus(Seeded& rng) {
    const auto whole = [&](int low, int high) { return static_cast<double>(rng.integer(low, high)); };
    const Vec<double> at{whole(-50, 50), whole(-50, 50), whole(-50, 50)};
    const double r = 25 * whole(1, 20);
    return {{at, {}}, {at, {0, 0, whole(1, 3)}, r + 25 * whole(1, 30), r}};
}
/// 3, 4 and 5 in some order and with some signs: a vector of whole numbers and length 5.
inline Vec<double> pythagorean(Seeded& rng) {
    const double x = 3 * rng.sign(), y = 4 * rng.sign();
    return rng.coin() ? Vec<double>(x, y, 0) : Vec<double>(y, x, 0);
}
inline double some(Seeded& rng, int low, int high) { return static_cast<double>(rng.integer(low, high)); }
/// From that many of d before a point, or the other way round.
inline void put_through(Sample<Torus>& s, Seeded& rng, const Vec<double>& at, const Vec<double>& d) {
    s.ray.direction = rng.sign() * d;
    s.ray.origin = s.solid.centre + at - some(rng, -40, 400) * d;
}
inline Sample<Torus> random_torus(Seeded& rng, double least, double most) {
    return {{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), 1, rng.uniform(least, most)}};
}
inline void aim(Sample<Torus>& s, Seeded& rng, double beside) {
    const double x = rng.unit(), y = rng.unit(), z = rng.unit();
    s.ray.direction = s.solid.point_at({x, y, z}) + beside * rng.vec(-1, 1) - s.ray.origin;
}

inline const SampledRays<Torus> torus_rays[] = {
    {"random",
     [](Seeded& rng) {
         Sample<Torus> s = random_torus(rng, 0.05, 0.95);
         aim(s, rng, 0.7);
         return s;
     }},
    {"grazing",
     [](Seeded& rng) {
         Sample<Torus> s = random_torus(rng, 0.05, 0.95);
         const Vec<double> p = s.solid.projected({}, s.solid.centre + rng.vec(-2, 2));
         const Vec<double> n = s.solid.outward_normal({}, p);
         s.ray.direction = cross(n, rng.vec(-1, 1));
         const double beside = rng.signed_magnitude(-30, -2);
         s.ray.origin = p + beside * n - rng.uniform(-1, 4) * s.ray.direction;
         return s;
     }},
    {"through the hole",
     [](Seeded& rng) {
         Sample<Torus> s = random_torus(rng, 0.5, 0.95);
         const double hole = 1 - s.solid.minor_radius;
         s.ray.origin = s.solid.centre + 3.0 * s.solid.axis + hole * rng.vec(-1, 1);
         s.ray.direction = s.solid.centre + 1.25 * hole * rng.vec(-1, 1) - s.ray.origin;
         return s;
     }},
    {"from the hole",
     [](Seeded& rng) {
         Sample<Torus> s = random_torus(rng, 0.05, 0.9);
         s.ray = {s.solid.centre + (1 - s.solid.minor_radius) * rng.vec(-0.5, 0.5), rng.vec(-1, 1)};
         return s;
     }},
    {"from inside",
     [](Seeded& rng) {
         Sample<Torus> s = random_torus(rng, 0.05, 0.95);
         const Vec<double> d = rng.vec(-1, 1);
         const double x = rng.unit(), y = rng.unit();
         s.ray = {s.solid.point_at({x, y, rng.uniform(0.1, 0.9)}), d};
         return s;
     }},
    {"along its top",
     [](Seeded& rng) {
         Sample<Torus> s = upright_torus(rng);
         const Vec<double> d = pythagorean(rng), across(-d.y, d.x, 0);
         // Across the axis at whole fifths of the major radius: that far away it touches once, nearer twice.
         const double share = some(rng, -6, 6) / 25;
         const double side = rng.sign(), off = rng.integer(0, 3) == 0 ? some(rng, -1, 1) : 0;
         const Vec<double> up(0, 0, side * s.solid.minor_radius + off);
         put_through(s, rng, share * s.solid.major_radius * across + up, d);
         return s;
     }},
    {"at an equator",
     [](Seeded& rng) {
         Sample<Torus> s = upright_torus(rng);
         const Vec<double> out = pythagorean(rng), along(-out.y, out.x, 0);
         const double radius = s.solid.major_radius + rng.sign() * s.solid.minor_radius;
         const double up = some(rng, -2, 2), side = some(rng, -2, 2);
         if (up == 0 && side == 0) return s;
         put_through(s, rng, (radius / 5) * out, up * Vec<double>(0, 0, 5) + side * along);
         return s;
     }},
    {"through the middle, along both sides",
     [](Seeded& rng) {
         Sample<Torus> s = upright_torus(rng);
         const double k = some(rng, 1, 20);
         s.solid.major_radius = 25 * k, s.solid.minor_radius = 15 * k;
         const double lean = rng.integer(0, 2) == 0 ? rng.sign() : 0;
         const Vec<double> out = pythagorean(rng);
         put_through(s, rng, {0, 0, 0}, 4.0 * out + Vec<double>(lean, 0, rng.sign() * 15));
         return s;
     }},
    {"across the axis",
     [](Seeded& rng) {
         Sample<Torus> s = upright_torus(rng);
         const Vec<double> d{some(rng, -9, 9), some(rng, -9, 9), some(rng, -9, 9)};
         put_through(s, rng, {0, 0, some(rng, -300, 300)}, d);
         return s;
     }},
    {"from the surface",
     [](Seeded& rng) {
         Sample<Torus> s = upright_torus(rng);
         const Vec<double> out = pythagorean(rng);
         const double fifth = s.solid.minor_radius / 5, side = rng.sign();
         const bool steep = rng.coin();
         const double away = side * (steep ? 3 : 4) * fifth, up = rng.sign() * (steep ? 4 : 3) * fifth;
         s.ray.origin = s.solid.centre + ((s.solid.major_radius + away) / 5) * out + Vec<double>(0, 0, up);
         s.ray.direction = rng.coin() ? rng.vec(-1, 1) : Vec<double>(-out.y, out.x, 0);
         return s;
     }},
    {"thin",
     [](Seeded& rng) {
         Sample<Torus> s = random_torus(rng, 0x1p-16, 0x1p-15);
         aim(s, rng, 0x1p-16);
         return s;
     }},
    {"hardly a hole",
     [](Seeded& rng) {
         Sample<Torus> s = random_torus(rng, 1 - 0x1p-18, 1 - 0x1p-22);
         const double beside = rng.magnitude(-24, -1);
         s.ray.direction = s.solid.centre + beside * rng.vec(-1, 1) - s.ray.origin;
         return s;
     }},
    {"far away",
     [](Seeded& rng) {
         Sample<Torus> s = random_torus(rng, 0.1, 0.9);
         const double x = rng.unit(), y = rng.unit(), z = rng.unit();
         s.ray.direction = rng.vec(-1, 1);
         s.ray.origin = s.solid.point_at({x, y, z}) + rng.vec(-1, 1) - 0x1p20 * s.ray.direction;
         return s;
     }},
    {"tiny",
     [](Seeded& rng) {
         Sample<Torus> s = upright_torus(rng);
         const double x = rng.unit(), y = rng.unit(), z = rng.unit();
         s.ray.direction = Vec<double>(0.25, -0.5, 16);
         s.ray.origin = s.solid.point_at({x, y, z}) - 100.0 * s.ray.direction;
         return scaled(s, 0x1p-130);
     }},
    {"huge",
     [](Seeded& rng) {
         Sample<Torus> s = upright_torus(rng);
         const double x = rng.unit(), y = rng.unit(), z = rng.unit();
         s.ray.direction = Vec<double>(0.25, -0.5, 16);
         s.ray.origin = s.solid.point_at({x, y, z}) - 100.0 * s.ray.direction;
         return scaled(s, 0x1p110);
     }},
};

inline const ForEachSample for_each_torus{torus_rays, 0x7051};

}  // namespace lostbits::test
