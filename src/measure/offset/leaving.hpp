// The point where a ray has hit a primitive, the fixed set of rays that leave this point, and their origins, over any
// number type.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "number/rounded.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::offset {

/// Same point in object space, for a primitive under a matrix, where it is needed.
template <class T>
struct ObjectPoint {
    Ray<T> ray;
    T t;  ///< t of that ray
    Vec<T> p, n;
    Affine<T> to_world, to_object;
};

/// Input of a strategy: a ray hit a primitive at t, and a new one leaves in direction w. Everything is in world space.
/// A primitive under a matrix has no numbers there.
template <class T>
struct Leaving {
    Ray<T> ray;
    T t;
    Primitive<T> primitive;
    std::optional<ObjectPoint<T>> object = {};  ///< for a primitive under a matrix
    Vec<T> p;                                   ///< the point as computed
    Vec<T> n;                                   ///< the outward unit normal as computed
    Vec<T> w;                                   ///< new direction, of unit length up to rounding
    T side;                                     ///< sign(n·w): +1 away from the primitive, −1 into it
    T reach;                                    ///< distance to the target; infinite without one
};

/// New ray; only what it meets at tmin < t < tmax counts.
template <class T>
struct Respawn {
    Vec<T> origin;
    T tmin, tmax;
    bool tests_left_primitive = true;  ///< also tested against the primitive that it leaves
};

/// Hit point of a strategy: as computed, o + t·d, or projected onto the surface first.
enum class HitPoint : std::uint8_t { computed, projected };

/// p + k·v, component by component.
template <Number T>
Vec<T> moved(const Vec<T>& p, const T& k, const Vec<T>& v) {
    return Vec<T>(p.x + k * v.x, p.y + k * v.y, p.z + k * v.z);
}

/// Largest of |p.x|, |p.y|, |p.z|.
template <Number T>
T largest_of(const Vec<T>& p) {
    return max(max(abs(p.x), abs(p.y)), abs(p.z));
}

template <Number T>
Vec<T> outward_normal(const Ray<T>& ray, const Primitive<T>& primitive, const Vec<T>& p) {
    return visit(primitive, [&](const auto& shape) { return shape.outward_normal(ray, p); });
}

template <Number T>
Vec<T> projected(const Ray<T>& ray, const Primitive<T>& primitive, const Vec<T>& p) {
    return visit(primitive, [&](const auto& shape) { return shape.projected(ray, p); });
}

/// Side to which a ray leaves a primitive: by the sign of n·w as the format computes it.
enum class Side : std::uint8_t { outside, inside };
inline constexpr std::array<std::string_view, 2> side_names{"outside", "inside"};
inline constexpr std::string_view name_of(Side side) { return side_names[static_cast<std::size_t>(side)]; }
inline constexpr std::array both_sides{Side::outside, Side::inside};

/// Direction in which a ray leaves.
template <class T>
struct Departure {
    Vec<T> w;
    T side, reach;  ///< as in `Leaving`
};

/// Cosines of the angle to the normal. The first has one direction, each other one has four, a right angle apart.
inline constexpr std::array cosine_denominators{1, 2, 8, 64, 1024};
/// Ratio 1/η of a refracted ray that goes in from outside: glass of index 3/2.
inline constexpr std::array glass{2, 3};

/// Adds the ray w of length one, unless it lies in the surface or is not a direction.
template <Number T>
void add_departure(const Vec<T>& w, const Vec<T>& n, const T& reach, std::vector<Departure<T>>& departures) {
    const T cosine = dot(n, w);
    if (cosine > T(0)) departures.push_back({w, T(1), reach});
    else if (cosine < T(0)) departures.push_back({w, T(-1), reach});
}

/// The directions of all rays that leave a point, in order: to the light, where there is one and it lies outside;
/// mirrored, d − 2(d·n)n; refracted, where it is not mirrored totally; 17 over the hemisphere around n and the same
/// around −n. The hemisphere's frame is that of Duff et al., Building an Orthonormal Basis, Revisited (2017).
/// Everything is computed in T.
template <Number T>
std::vector<Departure<T>> departures_from(const Ray<T>& ray, const Vec<T>& p, const Vec<T>& n, const T& infinite,
                                          const std::optional<Vec<T>>& light) {
    std::vector<Departure<T>> departures;
    if (light) {
        const Vec<T> way = *light - p;
        if (dot(n, way) > T(0)) add_departure<T>(unit_of<T>(way), n, length(way), departures);
    }
    const Vec<T> d = unit_of<T>(ray.direction);
    const T facing = dot(d, n);
    add_departure<T>(moved<T>(d, -(T(2) * facing), n), n, infinite, departures);
    const bool enters = facing < T(0);
    const T eta = enters ? T(glass[0]) / T(glass[1]) : T(glass[1]) / T(glass[0]);
    const T cosine = abs(facing), rest = T(1) - eta * eta * (T(1) - cosine * cosine);
    if (rest > T(0)) {
        const T along = enters ? eta * cosine - sqrt(rest) : sqrt(rest) - eta * cosine;
        add_departure<T>(moved<T>(Vec<T>(eta * d.x, eta * d.y, eta * d.z), along, n), n, infinite, departures);
    }

    const T sign = copysign(T(1), n.z), a = T(-1) / (sign + n.z), b = n.x * n.y * a;
    const Vec<T> across(T(1) + sign * n.x * n.x * a, sign * b, -(sign * n.x)), up(b, sign + n.y * n.y * a, -n.y);
    for (const T& side : {T(1), T(-1)}) {
        for (const int denominator : cosine_denominators) {
            const T up_cosine = T(1) / T(denominator), sine = sqrt(T(1) - up_cosine * up_cosine);
            T x = T(3) / T(5), y = T(4) / T(5);
            for (int quarter = 0; quarter < (denominator == 1 ? 1 : 4); ++quarter) {
                const Vec<T> tangent = moved<T>(Vec<T>(x * across.x, x * across.y, x * across.z), y, up);
                const T height = side * up_cosine;
                add_departure<T>(moved<T>(Vec<T>(height * n.x, height * n.y, height * n.z), sine, tangent), n, infinite,
                                 departures);
                const T turned = -y;
                y = x;
                x = turned;
            }
        }
    }
    return departures;
}

}  // namespace lostbits::measure::offset
