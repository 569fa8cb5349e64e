// Any shape as plain numbers: what the table's kernels, the files and the searches hand around without knowing which.
// The closed list of shapes, and what each says of itself as a row of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

// clang-format off
#define LOSTBITS_TEXT_OF(path) #path
#define LOSTBITS_PATH(path) LOSTBITS_TEXT_OF(path)
#define LOSTBITS_SHAPE_FILE(folder) LOSTBITS_PATH(folder/folder.hpp)
// clang-format on
#include "shapes/list.hpp"
#include "shapes/on_one_line.hpp"
#include "shapes/placement.hpp"

namespace lostbits {

/// The solids of the laboratory, and what else a form can be asked about: `sdf` stands for all solids together, as one
/// field of distances. The values are those of the C interface.
#define LOSTBITS_LINE(folder, S) folder,
enum class Shape : std::uint8_t { LOSTBITS_SHAPES(LOSTBITS_LINE) sdf };
#undef LOSTBITS_LINE

/// `Shape::sphere` of `Sphere`; `sdf` of what is no shape.
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

    /// `act.template operator()<Sphere>()` for each shape in turn.
    template <class Act>
    static constexpr void each(const Act& act) {
        act.template operator()<First>(), (act.template operator()<Rest>(), ...);
    }
    /// `act.template operator()<Sphere>()` of the shape alone.
    template <Shape shape, class Act>
    static constexpr decltype(auto) of_shape(const Act& act) {
        if constexpr (shape_as<First> == shape) return act.template operator()<First>();
        else return ShapeList<Rest...>::template of_shape<shape>(act);
    }
    template <class Solid, class Act>
    static decltype(auto) visit(const Solid& solid, const Act& act) {
        if constexpr (sizeof...(Rest) > 0)
            if (!solid.template is<First>()) return ShapeList<Rest...>::visit(solid, act);
        return act(solid.template as<First>());
    }
};

namespace detail {
template <class, template <class> class... S>
using ListOf = ShapeList<S...>;
}  // namespace detail

#define LOSTBITS_LINE(folder, S) , S
using Solids = detail::ListOf<void LOSTBITS_SHAPES(LOSTBITS_LINE)>;
#undef LOSTBITS_LINE

/// A shape as data.
struct ShapeRow {
    Shape shape;
    std::string_view name, plural;
    std::span<const Key> keys;
    std::size_t numbers = 0;
    bool told_end = false;      ///< its forms are told where a ray ends
    bool zero_inside = false;   ///< from inside the answer is 0, where nothing else is said, and not the exit
    bool usually_unit = false;  ///< most code that meets it takes directions of length one
    bool round = false;         ///< its points are at one distance from a centre: it is the ball around it
    bool edges = false;         ///< its keys are corners, and rays can be aimed at the edges between
    ShapeWords words = {};
};

namespace detail {

inline constexpr std::array<ShapeRow, Solids::size> shape_rows = [] {
    std::array<ShapeRow, Solids::size> rows{};
    std::size_t row = 0;
    Solids::each([&]<template <class> class S>() {
        ShapeRow& r = rows[row++];
        using One = S<float>;
        r = {.shape = shape_as<S>,
             .name = One::name,
             .plural = One::plural,
             .keys = One::keys,
             .told_end = One::told_end,
             .zero_inside = One::zero_inside,
             .usually_unit = One::usually_unit,
             .round = One::round,
             .edges = One::edges,
             .words = One::words};
        for (const Key& key : r.keys) r.numbers += key.count();
    });
    return rows;
}();

}  // namespace detail

/// All shapes that a solid can have, in the order of the list.
inline constexpr std::span<const ShapeRow> shape_rows = detail::shape_rows;

/// Those, and what is not a solid.
inline constexpr std::array<Shape, shape_rows.size() + 1> all_shapes = [] {
    std::array<Shape, shape_rows.size() + 1> all{};
    std::ranges::transform(shape_rows, all.begin(), &ShapeRow::shape);
    all.back() = Shape::sdf;
    return all;
}();

inline constexpr bool is_solid(Shape shape) { return shape != Shape::sdf; }

/// Of a shape that a solid can have.
inline constexpr const ShapeRow& row_of(Shape shape) { return shape_rows[static_cast<std::size_t>(shape)]; }

/// Whether the forms of a shape are told where a ray ends.
inline constexpr bool told_end(Shape shape) { return is_solid(shape) && row_of(shape).told_end; }

inline constexpr bool zero_inside(Shape shape) { return is_solid(shape) && row_of(shape).zero_inside; }

inline constexpr std::array<std::string_view, shape_rows.size() + 1> shape_names = [] {
    std::array<std::string_view, shape_rows.size() + 1> names{};
    for (const ShapeRow& row : shape_rows) names[static_cast<std::size_t>(row.shape)] = row.name;
    names[static_cast<std::size_t>(Shape::sdf)] = "sdf";
    return names;
}();
inline constexpr std::string_view name_of(Shape shape) { return shape_names[static_cast<std::size_t>(shape)]; }

/// Nothing where no shape has that name.
inline constexpr std::optional<Shape> shape_named(std::string_view name) {
    for (const Shape shape : all_shapes)
        if (name_of(shape) == name) return shape;
    return std::nullopt;
}

/// Some of the shapes, of one shape that alone, and whether solids stand under matrices.
class Shapes {
public:
    constexpr Shapes() = default;
    constexpr Shapes(Shape one) : bits_(1U << static_cast<unsigned>(one)) {}
    constexpr Shapes(std::span<const Shape> all) {
        for (const Shape one : all) *this |= one;
    }

    [[nodiscard]] constexpr bool has(Shape one) const { return (bits_ & Shapes(one).bits_) != 0; }
    /// Whether they are more than one.
    [[nodiscard]] constexpr bool are_several() const {
        const unsigned shapes = bits_ & ~placed_bit;
        return (shapes & (shapes - 1)) != 0;
    }
    /// The same under matrices, or as they are.
    [[nodiscard]] constexpr Shapes placed(bool under_matrix = true) const {
        Shapes all = *this;
        all.bits_ = under_matrix ? bits_ | placed_bit : bits_ & ~placed_bit;
        return all;
    }
    [[nodiscard]] constexpr bool are_placed() const { return (bits_ & placed_bit) != 0; }
    constexpr Shapes& operator|=(Shapes other) {
        bits_ |= other.bits_;
        return *this;
    }
    friend constexpr bool operator==(Shapes, Shapes) = default;

private:
    static constexpr unsigned placed_bit = 1U << 31;
    unsigned bits_ = 0;
};

inline constexpr std::size_t most_numbers = std::ranges::max(shape_rows, {}, &ShapeRow::numbers).numbers;

/// Of the numbers that solids are stored by: those of the shape, then those of the matrix.
inline constexpr std::size_t most_stored = most_numbers + Affine<double>::numbers;

/// A shape and its numbers in storage type S; what lies beyond those of the shape is zero. Under a matrix it stands
/// in the world where that takes it; else it is there as its numbers say.
template <class S>
struct Solid {
    Shape shape = shape_rows.front().shape;
    std::array<S, most_numbers> numbers = zeros();
    std::optional<Placement<S>> placed = {};

    Solid() = default;
    explicit Solid(Shape of) : shape(of) {}
    template <template <class> class Of>
    requires(shape_as<Of> != Shape::sdf) Solid(const Of<S>& solid) : shape(shape_as<Of>) {
        std::size_t k = 0;
        solid.each([&](const S& x) { numbers[k++] = x; });
    }

    /// The numbers of the shape, without those of its matrix.
    [[nodiscard]] std::span<const S> used() const { return std::span(numbers).first(row_of(shape).numbers); }
    [[nodiscard]] std::span<S> used() { return std::span(numbers).first(row_of(shape).numbers); }

    template <template <class> class Of>
    [[nodiscard]] bool is() const {
        return shape == shape_as<Of>;
    }
    /// The shape itself; ask for the one that `shape` names.
    template <template <class> class Of>
    [[nodiscard]] Of<S> as() const {
        return Of<S>::of([this](std::size_t k) { return numbers[k]; });
    }
    /// The point whose first coordinate is number `k`.
    [[nodiscard]] Vec<S> point(std::size_t k) const { return {numbers[k], numbers[k + 1], numbers[k + 2]}; }
    void set_point(std::size_t k, const Vec<S>& p) { numbers[k] = p.x, numbers[k + 1] = p.y, numbers[k + 2] = p.z; }
#define LOSTBITS_LINE(folder, S_) \
    [[nodiscard]] S_<S> folder() const { return as<S_>(); }
    LOSTBITS_SHAPES(LOSTBITS_LINE)
#undef LOSTBITS_LINE

private:
    static std::array<S, most_numbers> zeros() {
        return []<std::size_t... k>(std::index_sequence<k...>) {
            return std::array<S, most_numbers>{(static_cast<void>(k), S(0))...};
        }
        (std::make_index_sequence<most_numbers>());
    }
};

/// `act` on the shape itself: a template, or an overload for every shape.
template <class S, class Act>
decltype(auto) visit(const Solid<S>& solid, const Act& act) {
    return Solids::visit(solid, act);
}

/// A solid k > 0 times as large about the origin, without its matrix.
template <class S>
Solid<S> scaled(const Solid<S>& solid, const S& k) {
    Solid<S> larger(solid.shape);
    std::size_t i = 0;
    for (const Key& key : row_of(solid.shape).keys)
        for (const std::size_t end = i + key.count(); i < end; ++i)
            larger.numbers[i] = key.kind == Key::Kind::direction ? solid.numbers[i] : k * solid.numbers[i];
    return larger;
}

/// `act` on where the ray's line is inside of the solid. Distances are those of the world.
template <class S, class Act>
auto with_span(const Ray<S>& ray, const Solid<S>& solid, const Act& act) {
    if (!solid.placed) return visit(solid, [&](const auto& shape) { return act(shape.span(ray)); });
    const InObject<S> in = in_object(ray, *solid.placed);
    const Solid<S> object = scaled(solid, in.scale);
    return visit(object, [&](const auto& shape) {
        auto span = shape.span(in.ray);
        span.d2 = square(ray.direction);
        return act(span);
    });
}

/// The centre and the radius of a ball that holds it. Of a solid under a stored matrix |A p| ≤ ‖A‖ |p| with Frobenius'
/// norm; ask for none of one under a stored inverse.
template <class S>
auto ball_around(const Solid<S>& solid) {
    auto ball = visit(solid, [](const auto& shape) { return shape.ball_around(); });
    if (solid.placed) {
        const Affine<S> m = solid.placed->map();
        ball.centre = m.point(ball.centre);
        ball.radius = sqrt(square(m.rows[0]) + square(m.rows[1]) + square(m.rows[2])) * ball.radius;
    }
    return ball;
}

/// A solid of this shape around a point, as far as `half` from it on each axis.
template <class S>
Solid<S> solid_around(Shape shape, const Vec<S>& point, const S& half) {
    Solid<S> made(shape);
    visit(Solid<S>(made), [&]<template <class> class Of>(const Of<S>&) { made = Of<S>::around(point, half); });
    return made;
}

/// Each number through `lift`, in order; those of its matrix come last.
template <class S, class Lift>
auto transformed(const Solid<S>& from, Lift lift) {
    Solid<std::decay_t<std::invoke_result_t<Lift, const S&>>> to(from.shape);
    for (std::size_t i = 0; i < from.used().size(); ++i) to.numbers[i] = lift(from.numbers[i]);
    if (from.placed) to.placed = transformed(*from.placed, lift);
    return to;
}

/// Whether two points differ, and all of their numbers are numbers.
template <class S>
bool are_apart(const Vec<S>& a, const Vec<S>& b) {
    bool differ = false;
    for (int i = 0; i < 3; ++i) {
        if (!(a[i] < b[i] || a[i] >= b[i])) return false;
        differ = differ || a[i] != b[i];
    }
    return differ;
}

/// A limit of a key that these numbers break, and the number that breaks it: of a point on a line, its first. NaN
/// breaks every limit.
struct BrokenLimit {
    const Key* key;
    std::size_t number;
};
template <class S>
std::optional<BrokenLimit> broken_limit(const Solid<S>& solid) {
    std::size_t k = 0;
    for (const Key& key : row_of(solid.shape).keys) {
        if (key.limit == Key::Limit::off_line_before &&
            on_one_line(solid.point(k - 6), solid.point(k - 3), solid.point(k)))
            return BrokenLimit{&key, k};
        if (key.limit == Key::Limit::apart_from_before && !are_apart(solid.point(k - 3), solid.point(k)))
            return BrokenLimit{&key, k};
        if (key.limit == Key::Limit::not_zero && !are_apart(Vec<S>(S(0), S(0), S(0)), solid.point(k)))
            return BrokenLimit{&key, k};
        for (const std::size_t end = k + key.count(); k < end; ++k) {
            const S& x = solid.numbers[k];
            if ((key.limit == Key::Limit::positive && !(x > S(0))) ||
                (key.limit == Key::Limit::not_negative && !(x >= S(0))) ||
                (key.limit == Key::Limit::below_before && !(x >= S(0) && x < solid.numbers[k - 1])) ||
                (key.limit == Key::Limit::at_least_before && !(solid.numbers[k - key.count()] <= x)))
                return BrokenLimit{&key, k};
        }
    }
    return std::nullopt;
}

/// `act(key, place of its first number)` for each key of the solid's shape.
template <class Act>
void for_each_key(Shape shape, const Act& act) {
    std::size_t k = 0;
    for (const Key& key : row_of(shape).keys) {
        act(key, k);
        k += key.count();
    }
}

/// Whether the number at place k may be left out.
inline bool is_optional(Shape shape, std::size_t k) {
    bool optional = false;
    for_each_key(shape, [&](const Key& key, std::size_t first) {
        if (k >= first && k < first + key.count()) optional = key.optional;
    });
    return optional;
}

/// A key that is a length, and the place of its number.
struct LengthKey {
    const Key* key;
    std::size_t number;
};
/// The first of a shape; nothing where it has none.
inline std::optional<LengthKey> length_key(Shape shape) {
    std::optional<LengthKey> found;
    for_each_key(shape, [&found](const Key& key, std::size_t k) {
        if (!found && key.kind == Key::Kind::length) found = LengthKey{&key, k};
    });
    return found;
}

}  // namespace lostbits
