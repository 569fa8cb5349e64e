// What is intersected with what, over any number.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "geometry/key.hpp"
#include "geometry/vec.hpp"

namespace lostbits {

/// R(t) = origin + t·direction. The direction has any length but zero; t is in units of that length.
template <class T>
struct Ray {
    Vec<T> origin;
    Vec<T> direction;
};

/// The solids of the laboratory, and what else a form can be asked about: `sdf` stands for all solids together, as one
/// field of distances. The values are those of the C interface.
enum class Shape : std::uint8_t { sphere, box, sdf };

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

/// All points p with lo ≤ p ≤ hi in each component: closed, axis-aligned. A side may have zero thickness (lo = hi).
template <class T>
struct Box {
    Vec<T> lo;
    Vec<T> hi;

    static constexpr Shape shape = Shape::box;
    static constexpr std::string_view name = "box", plural = "boxes";
    static constexpr bool told_end = true, zero_inside = true;
    static constexpr std::array<Key, 2> keys{
        {{.name = "lo", .letter = "lo"}, {.name = "hi", .letter = "hi", .limit = Key::Limit::at_least_before}}};

    template <class Numbers>
    static constexpr Box of(const Numbers& number) {
        return {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
    }
    template <class Take>
    constexpr void each(const Take& take) const {
        take(lo.x), take(lo.y), take(lo.z), take(hi.x), take(hi.y), take(hi.z);
    }

    [[nodiscard]] Vec<T> middle() const { return (T(1) / T(2)) * (lo + hi); }
    [[nodiscard]] T half_extent() const {
        const Vec<T> side = hi - lo;
        return max(max(side.x, side.y), side.z) / 2;
    }
    [[nodiscard]] Sphere<T> ball_around() const {
        const T half = T(1) / T(2);
        return {half * lo + half * hi, half * length(Vec<T>(hi - lo))};
    }
    /// The point at these shares of its sides.
    [[nodiscard]] Vec<T> point_at(const Vec<T>& u) const {
        return {lo.x + u.x * (hi.x - lo.x), lo.y + u.y * (hi.y - lo.y), lo.z + u.z * (hi.z - lo.z)};
    }
    [[nodiscard]] std::optional<Box> grown(const Vec<T>& still, const T& k) const {
        Box to;
        for (int i = 0; i < 3; ++i) {
            const T there = min(max(still[i], lo[i]), hi[i]);
            to.lo[i] = there + k * (lo[i] - there);
            to.hi[i] = there + k * (hi[i] - there);
        }
        return to;
    }
};

/// A form's answer. `hit` is its own decision for "there is an intersection with t ≥ 0", `t` the first such;
/// `near ≤ far` are the line parameters of both intersections where the form yields them (its `Info` says).
/// Where `hit` is false the numbers mean nothing.
template <class T>
struct Hit {
    mask_t<T> hit;
    T t;
    T near;
    T far;
};

}  // namespace lostbits
