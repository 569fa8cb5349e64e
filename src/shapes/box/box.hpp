// The axis-aligned box.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "geometry/key.hpp"
#include "geometry/ray.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits {

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

}  // namespace lostbits
