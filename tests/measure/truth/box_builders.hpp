// Pieces that the distributions of rays and boxes share: integer boxes, points on their planes, rays that reach a point
// exactly.
#pragma once

#include <array>
#include <utility>

#include "measure/truth/box_distributions.hpp"

namespace lostbits::test {

using Integers = std::array<std::int64_t, 3>;

inline Vec<double> to_vec(const Integers& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

inline double draw_zero(Seeded& rng) { return rng.coin() ? 0.0 : -0.0; }

/// Corners in order, whatever order they were drawn in.
inline Box<double> box_between(Vec<double> a, Vec<double> b) {
    for (int i = 0; i < 3; ++i) {
        if (a[i] > b[i]) std::swap(a[i], b[i]);
    }
    return {a, b};
}

inline Box<double> draw_box(Seeded& rng, double low, double high) {
    const Vec<double> a = rng.vec(low, high);
    const Vec<double> b = rng.vec(low, high);
    return box_between(a, b);
}

inline BoxSample stored(BoxSample s, const FloatFormat& format) {
    return {{stored(s.ray.origin, format), stored(s.ray.direction, format)},
            {stored(s.box.lo, format), stored(s.box.hi, format)},
            stored(s.tmax, format)};
}

/// All lengths times 2^lengths and the direction times 2^direction: t is multiplied by 2^(lengths − direction).
inline BoxSample rescale(BoxSample s, int lengths, int direction) {
    for (int i = 0; i < 3; ++i) {
        s.ray.origin[i] = std::ldexp(s.ray.origin[i], lengths);
        s.ray.direction[i] = std::ldexp(s.ray.direction[i], direction);
        s.box.lo[i] = std::ldexp(s.box.lo[i], lengths);
        s.box.hi[i] = std::ldexp(s.box.hi[i], lengths);
    }
    s.tmax = std::ldexp(s.tmax, lengths - direction);
    return s;
}

/// A box with integer corners, each side even and at least 2 long.
inline Box<double> draw_integer_box(Seeded& rng) {
    Integers lo, hi;
    for (std::size_t i = 0; i < 3; ++i) {
        lo[i] = rng.integer(-1000, 1000);
        hi[i] = lo[i] + 2 * rng.integer(1, 300);
    }
    return {to_vec(lo), to_vec(hi)};
}

/// A point of the box: on the planes lo (−1) or hi (+1) of each axis, or strictly between them (0).
inline Vec<double> draw_point_at(Seeded& rng, const Box<double>& box, const std::array<int, 3>& place) {
    Vec<double> p(0);
    for (int i = 0; i < 3; ++i) {
        const int where = place[i];
        const auto side = static_cast<std::int64_t>(box.hi[i] - box.lo[i]);
        p[i] = where < 0   ? box.lo[i]
               : where > 0 ? box.hi[i]
                           : box.lo[i] + static_cast<double>(rng.integer(1, std::max<std::int64_t>(side - 1, 1)));
    }
    return p;
}

/// Integer components of either sign, none of them zero.
inline Vec<double> draw_integer_direction(Seeded& rng) {
    Vec<double> d(0);
    for (int i = 0; i < 3; ++i) {
        const double size = static_cast<double>(rng.integer(1, 60));
        d[i] = rng.coin() ? size : -size;
    }
    return d;
}

/// A ray through p at t = steps, exactly; a third of them end somewhere near there.
inline BoxSample draw_ray_through(Seeded& rng, const Box<double>& box, const Vec<double>& p, const Vec<double>& d,
                                  std::int64_t furthest = 400) {
    const auto steps = static_cast<double>(rng.integer(-furthest / 8, furthest));
    const Vec<double> origin = p - steps * d;
    const double tmax = rng.index(3) == 0 ? std::fabs(steps) + static_cast<double>(rng.integer(-2, 2)) : HUGE_VAL;
    return {{origin, d}, box, tmax};
}

inline std::array<int, 3> shuffle(Seeded& rng, std::array<int, 3> v) {
    for (int i = 2; i > 0; --i) std::swap(v[i], v[rng.index(i + 1)]);
    return v;
}

inline int draw_side(Seeded& rng) { return rng.coin() ? 1 : -1; }

}  // namespace lostbits::test
