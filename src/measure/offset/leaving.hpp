// The point where a ray has met a solid, and where the next one starts: over any number.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "number/rounded.hpp"
#include "shapes/solid.hpp"

namespace lostbits::measure::offset {

/// The same point in the space of a solid that stands under a matrix, where that is asked.
template <class T>
struct ObjectPoint {
    Ray<T> ray;
    T t;  ///< of that ray
    Vec<T> p, n;
    Affine<T> to_world, to_object;
};

/// What a strategy is given: a ray met a solid at t, and a new one leaves in direction w. All is of the world but the
/// numbers of a solid under a matrix, which has none here.
template <class T>
struct Leaving {
    Ray<T> ray;
    T t;
    Solid<T> solid;
    std::optional<ObjectPoint<T>> object = {};  ///< of a solid under a matrix
    Vec<T> p;                                   ///< the point as computed
    Vec<T> n;                                   ///< the outward unit normal as computed
    Vec<T> w;                                   ///< unit up to rounding
    T side;                                     ///< sign(n·w): +1 away from the solid, −1 into it
    T reach;                                    ///< how far away what is aimed at is; infinite where nothing is
};

/// What the new ray is: only what it meets at tmin < t < tmax counts.
template <class T>
struct Respawn {
    Vec<T> origin;
    T tmin, tmax;
    bool asks_own = true;  ///< also of the solid that it leaves
};

/// Whether the point is taken as it was computed, o + t·d, or put onto the surface first.
enum class HitPoint : std::uint8_t { computed, projected };

/// p + k·v, component by component.
template <Number T>
Vec<T> moved(const Vec<T>& p, const T& k, const Vec<T>& v) {
    return Vec<T>(p.x + k * v.x, p.y + k * v.y, p.z + k * v.z);
}

/// v/|v|.
template <Number T>
Vec<T> normalised(const Vec<T>& v) {
    const T size = length(v);
    return Vec<T>(v.x / size, v.y / size, v.z / size);
}

/// The largest of |p.x|, |p.y|, |p.z|.
template <Number T>
T largest_of(const Vec<T>& p) {
    return max(max(abs(p.x), abs(p.y)), abs(p.z));
}

template <Number T>
Vec<T> outward_normal(const Ray<T>& ray, const Solid<T>& solid, const Vec<T>& p) {
    return visit(solid, [&](const auto& shape) { return shape.outward_normal(ray, p); });
}

template <Number T>
Vec<T> projected(const Ray<T>& ray, const Solid<T>& solid, const Vec<T>& p) {
    return visit(solid, [&](const auto& shape) { return shape.projected(ray, p); });
}

/// The number n ≥ 0 places above zero in a format: the inverse of `truth::ordinal`.
inline double number_at(std::int64_t n, const FloatFormat& f) {
    const std::int64_t lead = std::int64_t{1} << (f.precision - 1);
    if (n < lead) return std::ldexp(static_cast<double>(n), f.emin - f.precision + 1);
    const std::int64_t binade = n / lead - 1;
    if (binade > f.emax - f.emin) return std::numeric_limits<double>::infinity();
    return std::ldexp(static_cast<double>(lead + n % lead), f.emin + static_cast<int>(binade) - f.precision + 1);
}

}  // namespace lostbits::measure::offset
