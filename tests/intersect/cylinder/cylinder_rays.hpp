// Rays at cylinders, in families that each do one thing.
#pragma once

#include "intersect/cone/capped_answer.hpp"
#include "intersect/sampled_rays.hpp"
#include "shapes/cylinder/cylinder.hpp"

namespace lostbits::test {

inline CappedAnswer answer_of(const Sample<Cylinder>& s) {
    return capped_answer(s.ray, s.solid.base, s.solid.top, s.solid.radius, s.solid.radius);
}

/// Along z, of whole numbers, with a radius that 3, 4 and 5 divide into a point of the circle.
inline Sample<Cylinder> upright_cylinder(Seeded& rng) {
    const auto whole = [&](int low, int high) { return static_cast<double>(rng.integer(low, high)); };
    const double x = whole(-50, 50), y = whole(-50, 50), z = whole(-50, 50), r = 5 * whole(1, 20),
                 height = whole(1, 99);
    return {{{}, {}}, {{x, y, z}, {x, y, z + height}, r}};
}
inline Vec<double> on_circle(const Cylinder<double>& c, Seeded& rng) {
    const double x = rng.sign() * 0.6 * c.radius, y = rng.sign() * 0.8 * c.radius;
    return {c.base.x + x, c.base.y + y, c.base.z};
}

inline const SampledRays<Cylinder> cylinder_rays[] = {
    {"random",
     [](Seeded& rng) {
         Sample<Cylinder> s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.05, 1)}};
         const double u = rng.uniform(-0.1, 1.1);
         const Vec<double> aside = rng.vec(-0.7, 0.7);
         s.ray.direction = s.solid.base + u * (s.solid.top - s.solid.base) + aside - s.ray.origin;
         return s;
     }},
    {"beside the axis",
     [](Seeded& rng) {
         Sample<Cylinder> s = upright_cylinder(rng);
         const Vec<double> at = on_circle(s.solid, rng);
         const double scale = rng.coin() ? 1 : rng.uniform(0, 1.5);
         s.ray.origin = {s.solid.base.x + scale * (at.x - s.solid.base.x),
                         s.solid.base.y + scale * (at.y - s.solid.base.y),
                         s.solid.base.z + static_cast<double>(rng.integer(-200, 200))};
         s.ray.direction = {0, 0, rng.sign()};
         return s;
     }},
    {"tangent",
     [](Seeded& rng) {
         Sample<Cylinder> s = upright_cylinder(rng);
         const auto& c = s.solid;
         const double side = rng.sign();
         s.ray.direction = {0, static_cast<double>(rng.integer(1, 4)), static_cast<double>(rng.integer(-4, 4))};
         const Vec<double> at(c.base.x + side * c.radius, c.base.y,
                              c.base.z + static_cast<double>(rng.integer(-5, 60)));
         s.ray.origin = at - static_cast<double>(rng.integer(-3, 30)) * s.ray.direction;
         return s;
     }},
    {"through a rim",
     [](Seeded& rng) {
         Sample<Cylinder> s = upright_cylinder(rng);
         Vec<double> at = on_circle(s.solid, rng);
         if (rng.coin()) at.z = s.solid.top.z;
         for (int i = 0; i < 3; ++i) s.ray.direction[i] = static_cast<double>(rng.integer(-9, 9));
         s.ray.origin = at - static_cast<double>(rng.integer(-2, 30)) * s.ray.direction;
         return s;
     }},
    {"in a cap",
     [](Seeded& rng) {
         Sample<Cylinder> s = upright_cylinder(rng);
         const auto& c = s.solid;
         s.ray.origin = {c.base.x + static_cast<double>(rng.integer(-150, 150)), c.base.y - (rng.coin() ? 200 : 1),
                         rng.coin() ? c.base.z : c.top.z + static_cast<double>(rng.integer(-1, 1))};
         s.ray.direction = {0, 1, 0};
         return s;
     }},
    {"from the surface",
     [](Seeded& rng) {
         Sample<Cylinder> s = upright_cylinder(rng);
         s.ray.origin = on_circle(s.solid, rng);
         if (rng.coin()) s.ray.origin.z = s.solid.top.z;
         else if (rng.coin()) s.ray.origin.x = s.solid.base.x;
         else s.ray.origin.z = 0.5 * (s.solid.base.z + s.solid.top.z);
         s.ray.direction = rng.vec(-1, 1);
         return s;
     }},
    {"from inside",
     [](Seeded& rng) {
         Sample<Cylinder> s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.5, 1)}};
         const Vec<double> aside = rng.vec(-0.1, 0.1);
         s.ray.origin = 0.5 * (s.solid.base + s.solid.top) + aside;
         return s;
     }},
    {"nearly beside the axis",
     [](Seeded& rng) {
         Sample<Cylinder> s{{{}, {}}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)}};
         const Vec<double> v = s.solid.top - s.solid.base, aside = rng.vec(-0.8, 0.8), off = rng.vec(-1, 1);
         s.ray = {s.solid.base - 3.0 * v + aside, v + 0x1p-20 * off};
         return s;
     }},
    {"thin",
     [](Seeded& rng) {
         Sample<Cylinder> s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), 0x1p-20}};
         const Vec<double> aside = 0x1p-20 * rng.vec(-1.5, 1.5);
         s.ray.direction = 0.5 * (s.solid.base + s.solid.top) + aside - s.ray.origin;
         return s;
     }},
    {"far away",
     [](Seeded& rng) {
         Sample<Cylinder> s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)}};
         const Vec<double> aside = rng.vec(-1, 1);
         s.ray.origin = s.solid.base + aside - 0x1p20 * s.ray.direction;
         return s;
     }},
    {"tiny", [](Seeded& rng) { return scaled_from_below(upright_cylinder(rng), 0x1p-140); }},
    {"huge", [](Seeded& rng) { return scaled_from_below(upright_cylinder(rng), 0x1p110); }},
};

inline const ForEachSample for_each_cylinder{cylinder_rays, 0x7a6};

}  // namespace lostbits::test
