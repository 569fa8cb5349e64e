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

/// The hit point of a transformed primitive, in the object space of the primitive.
template <class T>
struct ObjectPoint {
    Ray<T> ray;
    T t;  ///< t of the hit along this ray
    Vec<T> point, normal;
    Affine<T> to_world, to_object;
};

/// Input of a strategy: a ray hit a primitive at t, and a new ray leaves the hit point. Everything but `object_point`
/// is in world space. The numbers of a transformed primitive are in its object space.
template <class T>
struct StrategyInput {
    Ray<T> ray;
    T t;
    Primitive<T> primitive;
    std::optional<ObjectPoint<T>> object_point = {};  ///< for a transformed primitive
    Vec<T> point;                                     ///< as computed
    Vec<T> normal;                                    ///< the outward unit normal as computed
    Vec<T> new_direction;                             ///< of unit length up to rounding
    T side_sign;        ///< sign of normal·new_direction: +1 outward, −1 into the primitive
    T target_distance;  ///< distance to the target; infinite without one
};

/// Result of a strategy: the start of the new ray. Only hits at tmin < t < tmax count.
template <class T>
struct StrategyOutput {
    Vec<T> origin;
    T tmin, tmax;
    bool tests_departed_primitive = true;  ///< the ray is also tested against the primitive that it leaves
};

/// Kind of the point from which a strategy starts: as computed, o + t·d, or this point projected onto the surface.
enum class HitPointKind : std::uint8_t { computed, projected };

/// Returns p + k·v, component by component.
template <Number T>
Vec<T> add_scaled(const Vec<T>& p, const T& k, const Vec<T>& v) {
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
Vec<T> project_onto_surface(const Ray<T>& ray, const Primitive<T>& primitive, const Vec<T>& p) {
    return visit(primitive, [&](const auto& shape) { return shape.project_onto_surface(ray, p); });
}

/// Side of the surface to which a ray leaves the hit point: by the sign of n·w as the format computes it.
enum class Side : std::uint8_t { outside, inside };
inline constexpr std::array<std::string_view, 2> side_names{"outside", "inside"};
inline constexpr std::string_view name_of(Side side) { return side_names[static_cast<std::size_t>(side)]; }
inline constexpr std::array both_sides{Side::outside, Side::inside};

/// Direction in which a new ray leaves the hit point.
template <class T>
struct Departure {
    Vec<T> new_direction;
    T side_sign, target_distance;  ///< as in `StrategyInput`
};

/// The cosines of the angles between new ray and normal are 1 over these. At the first angle there is one direction, at
/// each other four, a right angle apart.
inline constexpr std::array cosine_denominators{1, 2, 8, 64, 1024};
/// Refractive index of the primitive, as a quotient: 3/2, that of glass.
inline constexpr std::array glass_index{3, 2};

/// Adds a ray in the unit direction w, unless w lies in the surface or is NaN. n is the normal.
template <Number T>
void add_departure(const Vec<T>& w, const Vec<T>& n, const T& target_distance, std::vector<Departure<T>>& departures) {
    const T cosine = dot(n, w);
    if (cosine > T(0)) departures.push_back({w, T(1), target_distance});
    else if (cosine < T(0)) departures.push_back({w, T(-1), target_distance});
}

/// Returns the directions of all rays that leave a point, in order: to the light, if there is one and it lies outside;
/// mirrored, d − 2(d·n)n; refracted, unless there is total reflection; 17 directions in the
/// hemisphere around n, and 17 in the one around −n. The frame of a hemisphere is that of Duff et al., Building an
/// Orthonormal Basis, Revisited (2017). Everything is computed in T.
template <Number T>
std::vector<Departure<T>> make_departures(const Ray<T>& ray, const Vec<T>& p, const Vec<T>& n,
                                          const T& infinite_distance, const std::optional<Vec<T>>& light) {
    std::vector<Departure<T>> departures;

    // To the light.
    if (light) {
        const Vec<T> to_light = *light - p;
        if (dot(n, to_light) > T(0)) add_departure<T>(unit_of<T>(to_light), n, length(to_light), departures);
    }

    // Mirrored.
    const Vec<T> d = unit_of<T>(ray.direction);
    const T facing = dot(d, n);
    add_departure<T>(add_scaled<T>(d, -(T(2) * facing), n), n, infinite_distance, departures);

    // Refracted.
    const bool enters = facing < T(0);
    const T index_ratio = enters ? T(glass_index[1]) / T(glass_index[0]) : T(glass_index[0]) / T(glass_index[1]);
    const T cosine = abs(facing), radicand = T(1) - index_ratio * index_ratio * (T(1) - cosine * cosine);
    if (radicand > T(0)) {
        const T normal_part = enters ? index_ratio * cosine - sqrt(radicand) : sqrt(radicand) - index_ratio * cosine;
        add_departure<T>(add_scaled<T>(Vec<T>(index_ratio * d.x, index_ratio * d.y, index_ratio * d.z), normal_part, n),
                         n, infinite_distance, departures);
    }

    // All over the two hemispheres.
    const T sign = copysign(T(1), n.z), a = T(-1) / (sign + n.z), b = n.x * n.y * a;
    const Vec<T> tangent(T(1) + sign * n.x * n.x * a, sign * b, -(sign * n.x)),
        bitangent(b, sign + n.y * n.y * a, -n.y);
    for (const T& side_sign : {T(1), T(-1)}) {
        for (const int denominator : cosine_denominators) {
            const T normal_cosine = T(1) / T(denominator), sine = sqrt(T(1) - normal_cosine * normal_cosine);
            T x = T(3) / T(5), y = T(4) / T(5);
            for (int quarter = 0; quarter < (denominator == 1 ? 1 : 4); ++quarter) {
                const Vec<T> in_plane =
                    add_scaled<T>(Vec<T>(x * tangent.x, x * tangent.y, x * tangent.z), y, bitangent);
                const T height = side_sign * normal_cosine;
                add_departure<T>(add_scaled<T>(Vec<T>(height * n.x, height * n.y, height * n.z), sine, in_plane), n,
                                 infinite_distance, departures);
                const T next_x = -y;
                y = x;
                x = next_x;
            }
        }
    }
    return departures;
}

}  // namespace lostbits::measure::offset
