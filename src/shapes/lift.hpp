// Converts stored rays and primitives to number types that enclose them.
#pragma once

#include <cmath>
#include <limits>
#include <span>

#include "geometry/ray.hpp"
#include "number/ball.hpp"
#include "number/real.hpp"
#include "number/with_number.hpp"
#include "shapes/primitive.hpp"

namespace lostbits {

/// Returns the sign of the determinant of a matrix; see `orientation_of` in transform.hpp.
int orientation_of(std::span<const Real, 12> matrix);

template <class E, class S>
E lift(const S& x) {
    return E(x);
}
/// Converts a 256-bit number to a ball: a double-double, and a radius that covers the rest.
template <>
inline Ball lift<Ball, Real>(const Real& x) {
    const auto hi = x.convert_to<double>();
    if (!std::isfinite(hi)) return Ball::all_reals();
    const auto lo = Real(x - Real(hi)).convert_to<double>();
    const Real rest = Real(x - Real(hi)) - Real(lo);
    if (rest == 0) return Ball(hi, lo, 0);
    return std::fabs(hi) < 0x1p-800 ? Ball::all_reals() : Ball(hi, lo, std::fabs(hi) * 0x1p-104);
}

template <class E, class S>
Vec<E> lift_vec(const Vec<S>& v) {
    return Vec<E>(lift<E>(v.x), lift<E>(v.y), lift<E>(v.z));
}

template <class E, class S>
Ray<E> lift_ray(const Ray<S>& ray) {
    return {lift_vec<E>(ray.origin), lift_vec<E>(ray.direction)};
}

template <class E, class S>
Primitive<E> lift_primitive(const Primitive<S>& primitive) {
    return convert_numbers(primitive, [](const S& x) { return lift<E>(x); });
}

/// Converts the numbers of a format to the doubles that hold them.
template <class T>
Vec<double> as_doubles(const Vec<T>& v) {
    return {as_double(v.x), as_double(v.y), as_double(v.z)};
}
template <class T>
Ray<double> as_doubles(const Ray<T>& ray) {
    return {as_doubles(ray.origin), as_doubles(ray.direction)};
}
template <class T>
Primitive<double> as_doubles(const Primitive<T>& primitive) {
    return convert_numbers(primitive, [](const T& x) { return as_double(x); });
}

/// `nearest_double` returns the double nearest to a number, and `nearest_low_double` the double nearest to the
/// remainder. The latter is NaN if the sum of both may not be within 2^-104 of the number, relatively, as `lift`
/// requires.
inline double nearest_double(double x) { return x; }
inline double nearest_low_double(double) { return 0; }
inline double nearest_double(const Real& x) { return x.convert_to<double>(); }
inline double nearest_low_double(const Real& x) {
    const double hi = nearest_double(x);
    if (!std::isfinite(hi)) return std::numeric_limits<double>::quiet_NaN();
    const Real rest = x - Real(hi);
    if (rest == 0) return 0;
    return std::fabs(hi) < 0x1p-800 ? std::numeric_limits<double>::quiet_NaN() : rest.convert_to<double>();
}

}  // namespace lostbits
