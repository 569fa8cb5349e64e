// Finds the meaning of the columns of a file of rays.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shapes/primitive.hpp"

namespace lostbits::scene::ray_file {

/// Indices (slots) of the numbers of a record that have a meaning: the ray (or a point, as its origin), its range, its
/// primitive, its answer, and the matrix of its primitive, row by row.
namespace slot {
inline constexpr std::size_t origin = 0, direction = 3, tmax = 6, tmin = 7, primitive = 8;
inline constexpr std::size_t t = primitive + max_number_count, hit = t + 1, object = t + 2;
inline constexpr std::size_t hit_index = t + 3, crossings = t + 4, parity = t + 5, inside = t + 6, matrix = t + 7;
inline constexpr std::size_t count = matrix + Affine<double>::number_count;
}  // namespace slot

/// The names of the columns of a matrix, row by row.
inline constexpr std::array<std::string_view, Affine<double>::number_count> matrix_columns{
    "m00", "m01", "m02", "m03", "m10", "m11", "m12", "m13", "m20", "m21", "m22", "m23"};

/// Subject of the answers of a file.
enum class AnswerKind : std::uint8_t {
    none,
    first_hit,  ///< each record is a ray and its first hit
    all_hits,   ///< each record is one hit of a ray, `hit_index` from 0; records of one ray follow each other
    crossings,  ///< each record is a ray, and the number of times it crosses the surface
    parity,     ///< each record is a ray, and its number of crossings modulo 2
    inside      ///< each record is a point, and 1 if the point is inside, else 0
};
inline constexpr std::array<std::string_view, 6> answer_kind_names{"none",      "first hit", "all hits",
                                                                   "crossings", "parity",    "inside"};

/// Slot of the number that is the answer of each record, for kinds after `first_hit`.
constexpr std::size_t slot_of(AnswerKind kind) {
    return slot::hit_index + static_cast<std::size_t>(kind) - static_cast<std::size_t>(AnswerKind::all_hits);
}

/// One column of a file.
struct LayoutColumn {
    std::string name;                 ///< as in the file
    std::optional<std::size_t> slot;  ///< absent: the column is kept unchanged, or skipped
    bool is_skipped = false;          ///< true if it is named `_`: neither read nor kept
};

/// Layout of a file: its columns in their order. Each number of a record has at most one column.
class Layout {
public:
    /// Throws what `complain(column, why)` throws. `complain` is called for a ray of fewer than six numbers, an
    /// incomplete primitive or matrix, numbers of a sphere and of a box together, answers of two kinds, two columns of
    /// one number, and a name that looks like a misspelling of a known name that is missing. Names are also known in
    /// upper case, and with `_hex` at the end: if a file has `t` and `t_hex`, `t_hex` is read and `t` is kept.
    using Complain = std::function<void(std::size_t column, const std::string& why)>;
    Layout(std::vector<std::string> names, const Complain& complain);

    [[nodiscard]] const std::vector<LayoutColumn>& columns() const { return columns_; }
    [[nodiscard]] bool has(std::size_t slot) const { return column_of_slot_.at(slot).has_value(); }
    /// Index of the column of a number for which `has` is true.
    [[nodiscard]] std::size_t index_of(std::size_t slot) const { return column_of_slot_.at(slot).value(); }
    /// Shape of the primitive that each record has; nothing if records have none.
    [[nodiscard]] std::optional<Shape> primitive_shape() const { return primitive_shape_; }
    /// True if each record has the matrix of its primitive.
    [[nodiscard]] bool has_matrix() const { return has(slot::matrix); }
    [[nodiscard]] AnswerKind answer_kind() const;
    /// True if the records are points: there are no columns of a direction.
    [[nodiscard]] bool are_points() const { return answer_kind() == AnswerKind::inside; }
    /// True if a column tells whether or where each ray hits first.
    [[nodiscard]] bool has_first_hits() const { return has(slot::t) || has(slot::hit); }
    /// True if the answers are decisions without a t.
    [[nodiscard]] bool has_only_decisions() const { return has(slot::hit) && !has(slot::t); }
    /// Names of the columns that are kept unchanged.
    [[nodiscard]] std::vector<std::string> kept_columns() const;

private:
    void find_slots(const Complain& complain);
    /// Makes column c the one of a slot. `shape` is the shape that has the slot; absent for numbers of all files.
    void give_slot(std::size_t c, std::size_t slot, std::optional<Shape> shape, const Complain& complain);
    /// Complains about a ray that lacks the columns `names`, and asks about a name that may be misspelt.
    void complain_of_ray(const std::string& names, const Complain& complain) const;
    void require_complete(const Complain& complain) const;
    void require_one_kind(const Complain& complain) const;
    [[nodiscard]] bool has_any_of_matrix() const;

    std::vector<LayoutColumn> columns_;
    std::array<std::optional<std::size_t>, slot::count> column_of_slot_;
    std::optional<Shape> primitive_shape_;
};

/// Returns the name of a number of a record in messages and files: `ox`, `cx`, `lox`. For numbers of a primitive,
/// `shape` is its shape.
std::string_view name_of_slot(std::size_t slot, std::optional<Shape> shape);

/// Returns the names of the columns that one name stands for: `origin` or `o` (3), `direction` or `d` (3), `centre`
/// (3), `lo` (3), `hi` (3), `sphere` (4), `box` (6), `ray` (6), `matrix` (12). Empty for other names and other counts.
std::vector<std::string> columns_of_name(std::string_view name, std::size_t count);

}  // namespace lostbits::scene::ray_file
