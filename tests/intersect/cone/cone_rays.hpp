// Rays at cones, in families that each do one thing.
#pragma once

#include "intersect/cone/capped_answer.hpp"
#include "intersect/sampled_rays.hpp"
#include "shapes/cone/cone.hpp"

namespace lostbits::test {

inline CappedAnswer answer_of(const Sample<Cone>& s) {
    return capped_answer(s.ray, s.solid.base, s.solid.top, s.solid.base_radius, s.solid.top_radius);
}

/// Along z, of whole numbers: the radius falls by 3 for each 4 of height, so that sides are directions of whole
/// numbers.
inline Sample<Cone> upright_cone(Seeded& rng) {
    const auto whole = [&](int low, int high) { return static_cast<double>(rng.integer(low, high)); };
    const double x = whole(-50, 50), y = whole(-50, 50), z = whole(-50, 50), steps = whole(1, 20);
    const double top = rng.coin() ? 0 : 5 * whole(1, 20);
    return {{{}, {}}, {{x, y, z}, {x, y, z + 20 * steps}, 15 * steps + top, top}};
}
/// The place on the side, `k` twentieths of the way up, in a direction that 3, 4 and 5 give.
inline Vec<double> on_side(const Cone<double>& c, double k, double x, double y) {
    const double share = k / 20, r = c.base_radius + share * (c.top_radius - c.base_radius);
    return {c.base.x + x * r, c.base.y + y * r, c.base.z + share * (c.top.z - c.base.z)};
}

inline const SampledRays<Cone> cone_rays[] = {
    {"random",
     [](Seeded& rng) {
         Sample<Cone> s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.05, 1), 0}};
         if (rng.coin()) s.solid.top_radius = rng.uniform(0, 1.5);
         const double u = rng.uniform(-0.1, 1.1);
         const Vec<double> aside = rng.vec(-0.7, 0.7);
         s.ray.direction = s.solid.base + u * (s.solid.top - s.solid.base) + aside - s.ray.origin;
         return s;
     }},
    {"steep",
     [](Seeded& rng) {
         Sample<Cone> s{{{}, {}}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.5, 2), rng.uniform(0, 1)}};
         const Vec<double> v = s.solid.top - s.solid.base, aside = rng.vec(-1.5, 1.5), off = rng.vec(-0.3, 0.3);
         s.ray = {s.solid.base - rng.uniform(-3, 3) * v + aside, rng.sign() * v + off};
         return s;
     }},
    {"beside the side",
     [](Seeded& rng) {
         Sample<Cone> s = upright_cone(rng);
         const double shift = rng.coin() ? 0 : static_cast<double>(rng.integer(-30, 30));
         s.ray.direction = {-3.0, 0, 4.0};
         const Vec<double> at = on_side(s.solid, 0, 1, 0) +
                                Vec<double>(shift, rng.coin() ? 0 : static_cast<double>(rng.integer(-9, 9)), 0);
         s.ray.origin = at - static_cast<double>(rng.integer(-10, 30)) * s.ray.direction;
         if (rng.coin()) s.ray.direction = -s.ray.direction;
         return s;
     }},
    {"tangent",
     [](Seeded& rng) {
         Sample<Cone> s = upright_cone(rng);
         // In the plane that touches along a side: across it, and along it.
         const Vec<double> side(-3, 0, 4), across(0, 1, 0);
         const double along = static_cast<double>(rng.integer(-3, 3));
         s.ray.direction = along * side + static_cast<double>(rng.integer(1, 5)) * across;
         const Vec<double> at = on_side(s.solid, static_cast<double>(rng.integer(-3, 23)), 1, 0);
         s.ray.origin = at - static_cast<double>(rng.integer(-3, 30)) * s.ray.direction;
         return s;
     }},
    {"through the apex",
     [](Seeded& rng) {
         Sample<Cone> s = upright_cone(rng);
         s.solid.base_radius -= s.solid.top_radius, s.solid.top_radius = 0;
         for (int i = 0; i < 3; ++i) s.ray.direction[i] = static_cast<double>(rng.integer(-9, 9));
         s.ray.origin = s.solid.top - static_cast<double>(rng.integer(-9, 30)) * s.ray.direction;
         return s;
     }},
    {"through a rim",
     [](Seeded& rng) {
         Sample<Cone> s = upright_cone(rng);
         const Vec<double> at = on_side(s.solid, rng.coin() ? 0 : 20, 0.6 * rng.sign(), 0.8 * rng.sign());
         for (int i = 0; i < 3; ++i) s.ray.direction[i] = static_cast<double>(rng.integer(-9, 9));
         s.ray.origin = at - static_cast<double>(rng.integer(-2, 30)) * s.ray.direction;
         return s;
     }},
    {"in a cap",
     [](Seeded& rng) {
         Sample<Cone> s = upright_cone(rng);
         const auto& c = s.solid;
         s.ray.origin = {c.base.x + static_cast<double>(rng.integer(-150, 150)), c.base.y - (rng.coin() ? 500 : 1),
                         rng.coin() ? c.base.z : c.top.z + static_cast<double>(rng.integer(-1, 1))};
         s.ray.direction = {0, 1, 0};
         return s;
     }},
    {"from the surface",
     [](Seeded& rng) {
         Sample<Cone> s = upright_cone(rng);
         s.ray.origin = on_side(s.solid, static_cast<double>(rng.integer(0, 20)), 0.6 * rng.sign(), 0.8 * rng.sign());
         if (rng.integer(0, 2) == 0) s.ray.origin = s.solid.base;
         s.ray.direction = rng.vec(-1, 1);
         return s;
     }},
    {"from inside",
     [](Seeded& rng) {
         Sample<Cone> s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.5, 1), rng.uniform(0, 1)}};
         const Vec<double> aside = rng.vec(-0.1, 0.1);
         s.ray.origin = 0.5 * (s.solid.base + s.solid.top) + aside;
         return s;
     }},
    {"flat",
     [](Seeded& rng) {
         const Vec<double> at = rng.vec(-1, 1), v = 0x1p-16 * rng.vec(-1, 1), aside = rng.vec(-0.6, 0.6);
         Sample<Cone> s{{rng.vec(-4, 4), {}}, {at, at + v, rng.uniform(0.3, 1), 0}};
         s.ray.direction = at + aside - s.ray.origin;
         return s;
     }},
    {"a needle",
     [](Seeded& rng) {
         Sample<Cone> s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), 0x1p-16, 0}};
         const Vec<double> aside = 0x1p-16 * rng.vec(-1, 1);
         s.ray.direction = s.solid.base + 0.25 * (s.solid.top - s.solid.base) + aside - s.ray.origin;
         return s;
     }},
    {"far away",
     [](Seeded& rng) {
         Sample<Cone> s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1), 0}};
         const Vec<double> aside = rng.vec(-1, 1);
         s.ray.origin = s.solid.base + aside - 0x1p20 * s.ray.direction;
         return s;
     }},
    {"tiny", [](Seeded& rng) { return scaled_from_below(upright_cone(rng), 0x1p-140); }},
    {"huge", [](Seeded& rng) { return scaled_from_below(upright_cone(rng), 0x1p110); }},
};

inline const ForEachSample for_each_cone{cone_rays, 0xc09e};

}  // namespace lostbits::test
