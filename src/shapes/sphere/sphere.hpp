// The sphere.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/key.hpp"
#include "geometry/ray.hpp"

namespace lostbits {

/// All points at distance `radius` > 0 from `centre`.
template <class T>
struct Sphere {
    Vec<T> centre;
    T radius;

    static constexpr Shape shape = Shape::sphere;
    static constexpr std::string_view name = "sphere", plural = "spheres";
    static constexpr bool told_end = false, zero_inside = false;
    static constexpr std::array<Key, 2> keys{
        {{.name = "centre", .letter = "c", .aliases = {"center"}},
         {.name = "radius", .letter = "r", .kind = Key::Kind::length, .limit = Key::Limit::positive}}};

    /// Of the numbers `number(0)`, `number(1)`, …, in the order of the keys.
    template <class Numbers>
    static constexpr Sphere of(const Numbers& number) {
        return {{number(0), number(1), number(2)}, number(3)};
    }
    template <class Take>
    constexpr void each(const Take& take) const {
        take(centre.x), take(centre.y), take(centre.z), take(radius);
    }

    [[nodiscard]] Vec<T> middle() const { return centre; }
    /// Half of the longest side of the box around it.
    [[nodiscard]] T half_extent() const { return radius; }
    /// The centre and the radius of a ball that holds it.
    [[nodiscard]] Sphere ball_around() const { return *this; }
    /// The point at these shares of the sides of the cube around it.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        const auto along = [this](const T& c, const T& share) { return c + (2 * share - 1) * radius; };
        return {along(centre.x, u.x), along(centre.y, u.y), along(centre.z, u.z)};
    }
    /// k times as large, its point nearest to `still` where it was; nothing where no point is nearest.
    [[nodiscard]] std::optional<Sphere> grown(const Vec<T>& still, const T& k) const {
        const Vec<T> towards = still - centre;
        const T distance = length(towards);
        if (distance == 0) return std::nullopt;
        return Sphere{centre - ((k - 1) * radius / distance) * towards, k * radius};
    }
};

}  // namespace lostbits
