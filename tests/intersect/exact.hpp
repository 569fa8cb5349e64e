// Rays and spheres as exact fractions, and the exact answer: the projection of the centre onto the line and half the
// chord, with every decision taken on signs of fractions. No form computes it this way.
#pragma once

#include <array>

#include <boost/multiprecision/gmp.hpp>

#include "intersect/info.hpp"
#include "number/real.hpp"
#include "shapes/box/box.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits::test {

using Rational = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;
using Precise = BasicReal<6000>;
using Wide = BasicReal<2048>;

template <class T>
T real_from(const Rational& q) {
    T x;
    mpfr_set_q(x.backend().data(), q.backend().data(), MPFR_RNDN);
    return x;
}

/// A ray and a sphere; every number is dyadic.
struct Case {
    std::array<Rational, 3> origin, direction, centre;
    Rational radius;
};

template <class T>
Rational rational_from(const T& x) {
    Rational q;
    mpfr_get_q(q.backend().data(), x.backend().data());
    return q;
}

template <class T, class Lift>
Ray<T> lift_ray(const Case& x, Lift lift) {
    return {Vec<T>(lift(x.origin[0]), lift(x.origin[1]), lift(x.origin[2])),
            Vec<T>(lift(x.direction[0]), lift(x.direction[1]), lift(x.direction[2]))};
}

template <class T, class Lift>
Sphere<T> lift_sphere(const Case& x, Lift lift) {
    return {Vec<T>(lift(x.centre[0]), lift(x.centre[1]), lift(x.centre[2])), lift(x.radius)};
}

/// The line against the sphere: signs are exact, the parameters good to thousands of bits.
struct Solution {
    int discriminant;  ///< sign: −1 the line misses, 0 it touches, +1 it crosses
    int height;        ///< sign of |f|² − r²: −1 inside, 0 on the surface, +1 outside
    int ahead;         ///< sign of −f·d: −1 the centre lies behind the origin
    Precise near, far, length;

    [[nodiscard]] bool near_is_negative() const { return ahead < 0 || height < 0; }
    [[nodiscard]] bool far_is_negative() const { return ahead < 0 && height > 0; }
    /// No decision hangs on an equality, so arithmetic that rounds a little decides alike.
    [[nodiscard]] bool is_generic() const { return discriminant != 0 && height != 0; }
};

inline Rational dot(const std::array<Rational, 3>& u, const std::array<Rational, 3>& v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

inline std::array<Rational, 3> to_centre(const Case& x) {
    return {x.centre[0] - x.origin[0], x.centre[1] - x.origin[1], x.centre[2] - x.origin[2]};
}

/// The square of the centre's distance from the line: |g × d|²/|d|².
inline Rational line_distance_squared(const Case& x) {
    const auto g = to_centre(x);
    const auto& d = x.direction;
    const std::array<Rational, 3> moment{g[1] * d[2] - g[2] * d[1], g[2] * d[0] - g[0] * d[2],
                                         g[0] * d[1] - g[1] * d[0]};
    return dot(moment, moment) / dot(d, d);
}

inline Solution solve(const Case& x) {
    const auto g = to_centre(x);
    const Rational a = dot(x.direction, x.direction), projection = dot(g, x.direction), r2 = x.radius * x.radius;
    const Rational half_chord_squared = (r2 - line_distance_squared(x)) / a;  // in units of t²
    Solution s{half_chord_squared.sign(),  Rational(dot(g, g) - r2).sign(), projection.sign(), 0, 0,
               sqrt(real_from<Precise>(a))};
    if (s.discriminant < 0) return s;
    const Precise middle = real_from<Precise>(Rational(projection / a)),
                  half_chord = sqrt(real_from<Precise>(half_chord_squared));
    s.near = middle - half_chord;
    s.far = middle + half_chord;
    return s;
}

/// What a form should answer by its own contract.
struct Expected {
    bool asked = true;  ///< false where the contract says nothing (a near-only form from inside)
    bool hit = false;
    bool first_is_far = false;
};

inline Expected expect(const intersect::Info& info, const Solution& s) {
    Expected e;
    if (info.roots == intersect::Roots::near_only && s.height < 0) e.asked = false;
    if (s.discriminant < 0 || (s.discriminant == 0 && info.touching == intersect::Touching::miss)) return e;
    const bool zero_counts = info.at_origin == intersect::AtOrigin::hit;
    const bool near_is_zero = s.height == 0 && s.ahead >= 0, far_is_zero = s.height == 0 && s.ahead <= 0;
    const bool near_counts = near_is_zero ? zero_counts : !s.near_is_negative();
    const bool far_counts = far_is_zero ? zero_counts : !s.far_is_negative();
    e.first_is_far = !near_counts;
    e.hit = near_counts || (far_counts && info.roots != intersect::Roots::near_only);
    return e;
}

}  // namespace lostbits::test
