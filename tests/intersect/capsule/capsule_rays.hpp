// Rays at capsules, in families that each do one thing, and the exact answer in fractions: how near the line comes to
// the segment, a convex function of t that is one of three parabolas, by where on the axis the nearest point lies. No
// span and no form asks so.
#pragma once

#include <array>
#include <optional>

#include "intersect/exact.hpp"
#include "intersect/sampled_rays.hpp"
#include "shapes/capsule/capsule.hpp"

namespace lostbits::test {

/// The square of the distance from o + t d to the segment, less r²: a t² + 2 h t + c of the axis where the place along
/// it, low + t rate, is between 0 and size, and of an end beyond.
struct CapsuleAnswer {
    struct Parabola {
        Rational a = 0, h = 0, c = 0;
        [[nodiscard]] Rational at(const Rational& t) const { return (a * t + 2 * h) * t + c; }
    };
    Parabola start, side, end;
    Rational low = 0, rate = 0, size = 0;

    [[nodiscard]] Rational at(const Rational& t) const {
        const Rational place = low + t * rate;
        return place < 0 ? start.at(t) : place > size ? end.at(t) : side.at(t);
    }
    [[nodiscard]] bool holds(const Rational& t) const { return at(t) <= 0; }
    [[nodiscard]] bool is_within(const Rational& t) const { return at(t) < 0; }
    /// Where it is least for from ≤ t ≤ to: at the least of a parabola, or at an end of one.
    [[nodiscard]] Rational nearest(const std::optional<Rational>& from, const std::optional<Rational>& to = {}) const {
        std::array<std::optional<Rational>, 7> places;
        std::size_t k = 0;
        for (const Parabola* p : {&start, &side, &end})
            if (p->a > 0) places[k++] = Rational(-p->h / p->a);
        if (rate != 0) places[k++] = Rational(-low / rate), places[k++] = Rational((size - low) / rate);
        places[k++] = from, places[k++] = to;
        std::optional<Rational> best;
        for (const auto& t : places) {
            if (!t || (from && *t < *from) || (to && *t > *to)) continue;
            if (!best || at(*t) < at(*best)) best = t;
        }
        return best ? *best : Rational(0);
    }
    [[nodiscard]] bool meets() const { return holds(nearest(Rational(0))); }
    [[nodiscard]] bool goes_through() const { return at(nearest(std::nullopt)) < 0; }
    /// Whether t, off by at most e, may be the first point of the surface from the origin on.
    [[nodiscard]] bool is_first(const Rational& t, const Rational& e) const {
        const Rational here = at(0);
        if (here == 0) return t - e <= 0 && 0 <= t + e;
        if (here < 0) return holds(t - e) && at(t + e) >= 0;
        const Rational before = t - e > 0 ? nearest(Rational(0), Rational(t - e)) : Rational(0);
        return (at(before) > 0 || before == t - e) && holds(nearest(Rational(t - e), Rational(t + e)));
    }
    /// Whether no equality is near: a tangent, the origin on the surface, a line beside the axis.
    [[nodiscard]] bool is_clear() const {
        const auto is_near = [](const Rational& x) { return abs(x) * (1 << 20) < 1; };
        bool clear = !is_near(at(nearest(Rational(0)))) && !is_near(at(0)) && !is_near(side.a);
        for (const auto* p : {&start, &side, &end})
            clear = clear && abs(Rational(p->h * p->h - p->a * p->c)) * (1 << 20) > p->h * p->h;
        return clear;
    }
};

inline CapsuleAnswer answer_of(const Sample<Capsule>& s) {
    CapsuleAnswer x;
    Rational ff = 0, fd = 0, dd = 0, vf = 0, vd = 0, vv = 0, gg = 0, gd = 0;
    for (int i = 0; i < 3; ++i) {
        const Rational v = Rational(s.solid.end[i]) - Rational(s.solid.start[i]), d(s.ray.direction[i]);
        const Rational f = Rational(s.ray.origin[i]) - Rational(s.solid.start[i]), g = f - v;
        ff += f * f, fd += f * d, dd += d * d, vf += v * f, vd += v * d, vv += v * v, gg += g * g, gd += g * d;
    }
    const Rational r2 = Rational(s.solid.radius) * Rational(s.solid.radius);
    x.start = {dd, fd, ff - r2}, x.end = {dd, gd, gg - r2};
    x.side = {dd - vd * vd / vv, fd - vf * vd / vv, ff - vf * vf / vv - r2};
    x.low = vf, x.rate = vd, x.size = vv;
    return x;
}

/// Along z, of whole numbers, with a radius that 3, 4 and 5 divide into a point of the circle.
inline Sample<Capsule> upright_capsule(Seeded& rng) {
    const auto whole = [&](int low, int high) { return static_cast<double>(rng.integer(low, high)); };
    const double x = whole(-50, 50), y = whole(-50, 50), z = whole(-50, 50), r = 5 * whole(1, 20),
                 height = whole(1, 99);
    return {{{}, {}}, {{x, y, z}, {x, y, z + height}, r}};
}

inline const SampledRays<Capsule> capsule_rays[] = {
    {"random",
     [](Seeded& rng) {
         Sample<Capsule> s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.05, 1)}};
         const double u = rng.uniform(-0.5, 1.5);
         const Vec<double> aside = rng.vec(-0.7, 0.7);
         s.ray.direction = s.solid.start + u * (s.solid.end - s.solid.start) + aside - s.ray.origin;
         return s;
     }},
    {"beside the axis",
     [](Seeded& rng) {
         Sample<Capsule> s = upright_capsule(rng);
         const auto& c = s.solid;
         const double scale = rng.coin() ? 1 : rng.uniform(0, 1.5);
         s.ray.origin = {c.start.x + scale * 0.6 * c.radius, c.start.y + scale * 0.8 * c.radius,
                         c.start.z + static_cast<double>(rng.integer(-200, 200))};
         s.ray.direction = {0, 0, rng.sign()};
         return s;
     }},
    {"tangent",
     [](Seeded& rng) {
         Sample<Capsule> s = upright_capsule(rng);
         const auto& c = s.solid;
         s.ray.direction = {0, static_cast<double>(rng.integer(1, 4)), static_cast<double>(rng.integer(-4, 4))};
         const Vec<double> at(c.start.x + rng.sign() * c.radius, c.start.y,
                              c.start.z + static_cast<double>(rng.integer(-5, 60)));
         s.ray.origin = at - static_cast<double>(rng.integer(-3, 30)) * s.ray.direction;
         return s;
     }},
    {"tangent at an end",
     [](Seeded& rng) {
         Sample<Capsule> s = upright_capsule(rng);
         const auto& c = s.solid;
         const bool low = rng.coin();
         s.ray.origin = {c.start.x - 300, c.start.y + 0.6 * c.radius,
                         low ? c.start.z - 0.8 * c.radius : c.end.z + 0.8 * c.radius};
         s.ray.direction = {1, 0, 0};
         return s;
     }},
    {"through a seam",
     [](Seeded& rng) {
         Sample<Capsule> s = upright_capsule(rng);
         const auto& c = s.solid;
         const Vec<double> at(c.start.x + 0.6 * c.radius, c.start.y - 0.8 * c.radius, rng.coin() ? c.start.z : c.end.z);
         for (int i = 0; i < 3; ++i) s.ray.direction[i] = static_cast<double>(rng.integer(-9, 9));
         s.ray.origin = at - static_cast<double>(rng.integer(-2, 30)) * s.ray.direction;
         return s;
     }},
    {"across",
     [](Seeded& rng) {
         Sample<Capsule> s = upright_capsule(rng);
         const auto& c = s.solid;
         s.ray.origin = {c.start.x + static_cast<double>(rng.integer(-150, 150)), c.start.y - 200,
                         c.start.z + static_cast<double>(rng.integer(-120, 200))};
         s.ray.direction = {0, 1, 0};
         return s;
     }},
    {"from inside",
     [](Seeded& rng) {
         Sample<Capsule> s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.5, 1)}};
         const Vec<double> aside = rng.vec(-0.2, 0.2);
         s.ray.origin = s.solid.start + rng.uniform(-0.2, 1.2) * (s.solid.end - s.solid.start) + aside;
         return s;
     }},
    {"nearly beside the axis",
     [](Seeded& rng) {
         Sample<Capsule> s{{{}, {}}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)}};
         const Vec<double> v = s.solid.end - s.solid.start, aside = rng.vec(-0.8, 0.8), off = rng.vec(-1, 1);
         s.ray = {s.solid.start - 3.0 * v + aside, v + 0x1p-20 * off};
         return s;
     }},
    {"thin",
     [](Seeded& rng) {
         Sample<Capsule> s{{rng.vec(-4, 4), {}}, {rng.vec(-1, 1), rng.vec(-1, 1), 0x1p-20}};
         const Vec<double> aside = 0x1p-20 * rng.vec(-1.5, 1.5);
         s.ray.direction = 0.5 * (s.solid.start + s.solid.end) + aside - s.ray.origin;
         return s;
     }},
    {"far away",
     [](Seeded& rng) {
         Sample<Capsule> s{{{}, rng.vec(-1, 1)}, {rng.vec(-1, 1), rng.vec(-1, 1), rng.uniform(0.1, 1)}};
         const Vec<double> aside = rng.vec(-1, 1);
         s.ray.origin = s.solid.start + aside - 0x1p20 * s.ray.direction;
         return s;
     }},
    {"tiny", [](Seeded& rng) { return scaled_from_below(upright_capsule(rng), 0x1p-140); }},
    {"huge", [](Seeded& rng) { return scaled_from_below(upright_capsule(rng), 0x1p110); }},
};

inline const ForEachSample for_each_capsule{capsule_rays, 0x7a9};

}  // namespace lostbits::test
