// Rays at cylinders, in families that each do one thing.
#pragma once

#include "intersect/cone/capped_answer.hpp"
#include "measure/seeded.hpp"
#include "shapes/cylinder/cylinder.hpp"

namespace lostbits::test {

using testing::Seeded;

struct CylinderSample {
    Ray<double> ray;
    Cylinder<double> cylinder;
};

inline CappedAnswer answer_of(const CylinderSample& s) {
    return capped_answer(s.ray, s.cylinder.base, s.cylinder.top, s.cylinder.radius, s.cylinder.radius);
}

struct CylinderRays {
    const char* name;
    CylinderSample (*make)(Seeded&);
};

/// Along z, of whole numbers, with a radius that 3, 4 and 5 divide into a point of the circle.
inline CylinderSample upright_cylinder(Seeded& rng) {
    const auto whole = [&](int low, int high) { return static_cast<double>(rng.integer(low, high)); };
    const double x = whole(-50, 50), y = whole(-50, 50), z = whole(-50, 50), r = 5 * whole(1, 20),
                 height = whole(1, 99);
    return {{{}, {}}, {{x, y, z}, {x, y, z + height}, r}};
}
inline Vec<double> on_circle(const Cylinder<double>& c, Seeded& rng) {
    const double x = rng.sign() * 0.6 * c.radius, y = rng.sign() * 0.8 * c.radius;
    return {c.base.x + x, c.base.y + y, c.base.z};
}

inline const CylinderRays cylinder_rays[] = {
    {"random",
     [](Seeded& rng) {
         CylinderSample s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.05, 1)}};
         const double u = rng.uniform(-0.1, 1.1);
         const Vec<double> aside = rng.vec(-0.7, 0.7);
         s.ray.direction = s.cylinder.base + u * (s.cylinder.top - s.cylinder.base) + aside - s.ray.origin;
         return s;
     }},
    {"beside the axis",
     [](Seeded& rng) {
         CylinderSample s = upright_cylinder(rng);
         const Vec<double> at = on_circle(s.cylinder, rng);
         const double scale = rng.coin() ? 1 : rng.uniform(0, 1.5);
         s.ray.origin = {s.cylinder.base.x + scale * (at.x - s.cylinder.base.x),
                         s.cylinder.base.y + scale * (at.y - s.cylinder.base.y),
                         s.cylinder.base.z + static_cast<double>(rng.integer(-200, 200))};
         s.ray.direction = {0, 0, rng.sign()};
         return s;
     }},
    {"tangent",
     [](Seeded& rng) {
         CylinderSample s = upright_cylinder(rng);
         const auto& c = s.cylinder;
         const double side = rng.sign();
         s.ray.direction = {0, static_cast<double>(rng.integer(1, 4)), static_cast<double>(rng.integer(-4, 4))};
         const Vec<double> at(c.base.x + side * c.radius, c.base.y,
                              c.base.z + static_cast<double>(rng.integer(-5, 60)));
         s.ray.origin = at - static_cast<double>(rng.integer(-3, 30)) * s.ray.direction;
         return s;
     }},
    {"through a rim",
     [](Seeded& rng) {
         CylinderSample s = upright_cylinder(rng);
         Vec<double> at = on_circle(s.cylinder, rng);
         if (rng.coin()) at.z = s.cylinder.top.z;
         for (int i = 0; i < 3; ++i) s.ray.direction[i] = static_cast<double>(rng.integer(-9, 9));
         s.ray.origin = at - static_cast<double>(rng.integer(-2, 30)) * s.ray.direction;
         return s;
     }},
    {"in a cap",
     [](Seeded& rng) {
         CylinderSample s = upright_cylinder(rng);
         const auto& c = s.cylinder;
         s.ray.origin = {c.base.x + static_cast<double>(rng.integer(-150, 150)), c.base.y - (rng.coin() ? 200 : 1),
                         rng.coin() ? c.base.z : c.top.z + static_cast<double>(rng.integer(-1, 1))};
         s.ray.direction = {0, 1, 0};
         return s;
     }},
    {"from the surface",
     [](Seeded& rng) {
         CylinderSample s = upright_cylinder(rng);
         s.ray.origin = on_circle(s.cylinder, rng);
         if (rng.coin()) s.ray.origin.z = s.cylinder.top.z;
         else if (rng.coin()) s.ray.origin.x = s.cylinder.base.x;
         else s.ray.origin.z = 0.5 * (s.cylinder.base.z + s.cylinder.top.z);
         s.ray.direction = rng.vec(-1, 1);
         return s;
     }},
    {"from inside",
     [](Seeded& rng) {
         CylinderSample s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.5, 1)}};
         const Vec<double> aside = rng.vec(-0.1, 0.1);
         s.ray.origin = 0.5 * (s.cylinder.base + s.cylinder.top) + aside;
         return s;
     }},
    {"nearly beside the axis",
     [](Seeded& rng) {
         CylinderSample s{{{}, {}}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)}};
         const Vec<double> v = s.cylinder.top - s.cylinder.base, aside = rng.vec(-0.8, 0.8), off = rng.vec(-1, 1);
         s.ray = {s.cylinder.base - 3.0 * v + aside, v + 0x1p-20 * off};
         return s;
     }},
    {"thin",
     [](Seeded& rng) {
         CylinderSample s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), 0x1p-20}};
         const Vec<double> aside = 0x1p-20 * rng.vec(-1.5, 1.5);
         s.ray.direction = 0.5 * (s.cylinder.base + s.cylinder.top) + aside - s.ray.origin;
         return s;
     }},
    {"far away",
     [](Seeded& rng) {
         CylinderSample s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)}};
         const Vec<double> aside = rng.vec(-1, 1);
         s.ray.origin = s.cylinder.base + aside - 0x1p20 * s.ray.direction;
         return s;
     }},
    {"tiny",
     [](Seeded& rng) {
         CylinderSample s = upright_cylinder(rng);
         s.ray = {s.cylinder.base + Vec<double>(7, 11, -300), Vec<double>(0.25, -0.5, 16)};
         for (Vec<double>* const p : {&s.ray.origin, &s.cylinder.base, &s.cylinder.top}) *p = 0x1p-140 * *p;
         s.cylinder.radius *= 0x1p-140;
         return s;
     }},
    {"huge",
     [](Seeded& rng) {
         CylinderSample s = upright_cylinder(rng);
         s.ray = {s.cylinder.base + Vec<double>(7, 11, -300), Vec<double>(0.25, -0.5, 16)};
         for (Vec<double>* const p : {&s.ray.origin, &s.cylinder.base, &s.cylinder.top}) *p = 0x1p110 * *p;
         s.cylinder.radius *= 0x1p110;
         return s;
     }},
};

/// Every number rounded to binary32: those of constructed rays are short, and stay.
inline CylinderSample in_floats(CylinderSample s) {
    for (Vec<double>* const p : {&s.ray.origin, &s.ray.direction, &s.cylinder.base, &s.cylinder.top})
        *p = testing::stored(*p, binary32);
    s.cylinder.radius = testing::stored(s.cylinder.radius, binary32);
    return s;
}

/// `visit(family, sample)` of each family so many times; what has no height or no direction is left out.
template <class Visit>
void for_each_cylinder(int each, const Visit& visit) {
    for (const CylinderRays& family : cylinder_rays) {
        Seeded rng(0x7a6);
        for (int i = 0; i < each; ++i) {
            const CylinderSample s = in_floats(family.make(rng));
            if (s.ray.direction == Vec<double>(0, 0, 0) || s.cylinder.base == s.cylinder.top) continue;
            visit(family, s);
        }
    }
}

}  // namespace lostbits::test
