// Table of all shapes: one row of properties for each.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "geometry/flat_span.hpp"

// clang-format off
#define LOSTBITS_TEXT_OF(path) #path
#define LOSTBITS_PATH(path) LOSTBITS_TEXT_OF(path)
#define LOSTBITS_SHAPE_FILE(folder) LOSTBITS_PATH(folder/folder.hpp)
// clang-format on
#include "shapes/list.hpp"
#include "shapes/numbers_of.hpp"

namespace lostbits {

/// The shapes that a primitive can have, and `sdf`, the distance field of all primitives together. Each form is of one
/// of them. The values are those of the C interface.
#define LOSTBITS_LINE(folder, S) folder,
enum class Shape : std::uint8_t { LOSTBITS_SHAPES(LOSTBITS_LINE) sdf };
#undef LOSTBITS_LINE

/// `Shape::sphere` for `Sphere`; `sdf` for a template that is not a shape.
template <template <class> class S>
inline constexpr Shape shape_as = Shape::sdf;
#define LOSTBITS_LINE(folder, S) \
    template <>                  \
    inline constexpr Shape shape_as<S> = Shape::folder;
LOSTBITS_SHAPES(LOSTBITS_LINE)
#undef LOSTBITS_LINE

template <template <class> class First, template <class> class... Rest>
struct ShapeList {
    static constexpr std::size_t size = 1 + sizeof...(Rest);

    /// Calls `act.template operator()<Sphere>()` for each shape in turn.
    template <class Act>
    static constexpr void each(const Act& act) {
        act.template operator()<First>(), (act.template operator()<Rest>(), ...);
    }
    /// Calls `act.template operator()<Sphere>()` for this shape alone.
    template <Shape shape, class Act>
    static constexpr decltype(auto) of_shape(const Act& act) {
        if constexpr (shape_as<First> == shape) return act.template operator()<First>();
        else return ShapeList<Rest...>::template of_shape<shape>(act);
    }
    template <class Primitive, class Act>
    static decltype(auto) visit_shape(const Primitive& primitive, const Act& act) {
        if constexpr (sizeof...(Rest) > 0)
            if (!primitive.template is<First>()) return ShapeList<Rest...>::visit_shape(primitive, act);
        return act.template operator()<First>();
    }
};

namespace detail {
template <class, template <class> class... S>
using ListOf = ShapeList<S...>;
}  // namespace detail

#define LOSTBITS_LINE(folder, S) , S
using Primitives = detail::ListOf<void LOSTBITS_SHAPES(LOSTBITS_LINE)>;
#undef LOSTBITS_LINE

/// A shape as data.
struct ShapeRow {
    Shape shape;
    std::string_view name, plural;
    std::span<const Key> keys;
    std::size_t number_count = 0;
    bool takes_tmax = false;                    ///< its forms take tmax, where a ray ends
    bool inside_returns_zero = false;           ///< from inside, t is 0 and not the exit, unless a form says otherwise
    bool usually_takes_unit_direction = false;  ///< most code for this shape takes directions of length one
    bool is_ball = false;                       ///< it is its own bounding ball
    bool is_flat = false;                       ///< a flat surface with a normal: a ray meets its front or its back
    bool is_surface = false;                    ///< it has no inside: a line crosses it at single points
    bool has_edges = false;           ///< its keys are corners, and rays can be aimed at the edges between them
    bool has_shading_normal = false;  ///< it has a normal for shading, so pictures can be made of it
    ShapeTexts texts = {};
};

namespace detail {

template <class FloatShape>
concept Shaded = requires(const FloatShape& shape, const Vec<float>& p) {
    shape.shading_normal(p);
};

inline constexpr std::array<ShapeRow, Primitives::size> shape_rows = [] {
    std::array<ShapeRow, Primitives::size> rows{};
    std::size_t index = 0;
    Primitives::each([&]<template <class> class S>() {
        ShapeRow& shape_row = rows[index++];
        using FloatShape = S<float>;
        shape_row = {.shape = shape_as<S>,
                     .name = FloatShape::name,
                     .plural = FloatShape::plural,
                     .keys = FloatShape::keys,
                     .number_count = number_count<FloatShape>,
                     .takes_tmax = FloatShape::takes_tmax,
                     .inside_returns_zero = FloatShape::inside_returns_zero,
                     .usually_takes_unit_direction = FloatShape::usually_takes_unit_direction,
                     .is_ball = FloatShape::is_ball,
                     .is_flat = std::same_as<decltype(std::declval<FloatShape>().span(Ray<float>{})), FlatSpan<float>>,
                     .is_surface = SurfaceSpan<decltype(std::declval<FloatShape>().span(Ray<float>{})), float>,
                     .has_edges = FloatShape::has_edges,
                     .has_shading_normal = Shaded<FloatShape>,
                     .texts = FloatShape::texts};
    });
    return rows;
}();

}  // namespace detail

/// All shapes that a primitive can have, in the order of the list.
inline constexpr std::span<const ShapeRow> shape_rows = detail::shape_rows;

/// All shapes of primitives, and `sdf`.
inline constexpr std::array<Shape, shape_rows.size() + 1> all_shapes = [] {
    std::array<Shape, shape_rows.size() + 1> all{};
    std::ranges::transform(shape_rows, all.begin(), &ShapeRow::shape);
    all.back() = Shape::sdf;
    return all;
}();

inline constexpr bool is_primitive(Shape shape) { return shape != Shape::sdf; }

/// Returns the row of a shape that a primitive can have.
inline constexpr const ShapeRow& row_of(Shape shape) { return shape_rows[static_cast<std::size_t>(shape)]; }

/// True if the forms of a shape take tmax, where a ray ends.
inline constexpr bool takes_tmax(Shape shape) { return is_primitive(shape) && row_of(shape).takes_tmax; }

inline constexpr bool inside_returns_zero(Shape shape) {
    return is_primitive(shape) && row_of(shape).inside_returns_zero;
}
inline constexpr bool is_flat(Shape shape) { return is_primitive(shape) && row_of(shape).is_flat; }
inline constexpr bool has_inside(Shape shape) { return is_primitive(shape) && !row_of(shape).is_surface; }

inline constexpr std::array<std::string_view, shape_rows.size() + 1> shape_names = [] {
    std::array<std::string_view, shape_rows.size() + 1> names{};
    for (const ShapeRow& shape_row : shape_rows) names[static_cast<std::size_t>(shape_row.shape)] = shape_row.name;
    names[static_cast<std::size_t>(Shape::sdf)] = "sdf";
    return names;
}();
inline constexpr std::string_view name_of(Shape shape) { return shape_names[static_cast<std::size_t>(shape)]; }

/// Returns nothing if no shape has that name.
inline constexpr std::optional<Shape> shape_named(std::string_view name) {
    for (const Shape shape : all_shapes)
        if (name_of(shape) == name) return shape;
    return std::nullopt;
}

/// A set of shapes, and a flag that is set if the primitives have transforms. A single shape converts to it.
class Shapes {
public:
    constexpr Shapes() = default;
    constexpr Shapes(Shape shape) : bits_(1U << static_cast<unsigned>(shape)) {}
    constexpr Shapes(std::span<const Shape> shapes) {
        for (const Shape shape : shapes) *this |= shape;
    }

    [[nodiscard]] constexpr bool has(Shape shape) const { return (bits_ & Shapes(shape).bits_) != 0; }
    /// True if the set has more than one shape.
    [[nodiscard]] constexpr bool are_several() const {
        const unsigned shape_count = bits_ & ~transform_bit;
        return (shape_count & (shape_count - 1)) != 0;
    }
    /// Returns the same set, with or without the flag for transforms.
    [[nodiscard]] constexpr Shapes with_transform(bool has_transform = true) const {
        Shapes result = *this;
        result.bits_ = has_transform ? bits_ | transform_bit : bits_ & ~transform_bit;
        return result;
    }
    [[nodiscard]] constexpr bool have_transform() const { return (bits_ & transform_bit) != 0; }
    constexpr Shapes& operator|=(Shapes other) {
        bits_ |= other.bits_;
        return *this;
    }
    friend constexpr bool operator==(Shapes, Shapes) = default;

private:
    static constexpr unsigned transform_bit = 1U << 31;
    unsigned bits_ = 0;
};

inline constexpr std::size_t max_number_count = std::ranges::max(shape_rows, {}, &ShapeRow::number_count).number_count;

}  // namespace lostbits
