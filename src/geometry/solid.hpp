// Any shape as plain numbers: what the table's kernels, the files and the searches hand around without knowing which.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

#include "geometry/shapes.hpp"

namespace lostbits {

/// `sdf` is not a solid: it stands for forms that meet all solids together, as one field of distances.
enum class Shape : std::uint8_t { sphere, box, sdf };

inline constexpr std::array<std::string_view, 3> shape_names{"sphere", "box", "sdf"};
inline constexpr std::string_view name_of(Shape shape) { return shape_names[static_cast<std::size_t>(shape)]; }

/// The names of a solid's numbers, in their order; a solid has as many.
inline std::span<const std::string_view> number_names(Shape shape) {
    static constexpr std::array<std::string_view, 4> sphere{"centre_x", "centre_y", "centre_z", "radius"};
    static constexpr std::array<std::string_view, 6> box{"lo_x", "lo_y", "lo_z", "hi_x", "hi_y", "hi_z"};
    if (shape == Shape::sphere) return sphere;
    return box;
}

/// A shape and its numbers in storage type S; what lies beyond `number_names(shape)` is zero.
template <class S>
struct Solid {
    Shape shape = Shape::sphere;
    std::array<S, 6> numbers{S(0), S(0), S(0), S(0), S(0), S(0)};

    Solid() = default;
    Solid(const Sphere<S>& s)
        : shape(Shape::sphere), numbers{s.centre.x, s.centre.y, s.centre.z, s.radius, S(0), S(0)} {}
    Solid(const Box<S>& b) : shape(Shape::box), numbers{b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z} {}

    [[nodiscard]] std::span<const S> used() const { return std::span(numbers).first(number_names(shape).size()); }
    [[nodiscard]] std::span<S> used() { return std::span(numbers).first(number_names(shape).size()); }

    /// The shape itself; call the one that `shape` names.
    [[nodiscard]] Sphere<S> sphere() const { return {{numbers[0], numbers[1], numbers[2]}, numbers[3]}; }
    [[nodiscard]] Box<S> box() const {
        return {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
    }
};

/// Each number through `lift`, in order.
template <class S, class Lift>
auto transformed(const Solid<S>& from, Lift lift) {
    Solid<std::decay_t<std::invoke_result_t<Lift, const S&>>> to;
    to.shape = from.shape;
    for (std::size_t i = 0; i < from.used().size(); ++i) to.numbers[i] = lift(from.numbers[i]);
    return to;
}

}  // namespace lostbits
