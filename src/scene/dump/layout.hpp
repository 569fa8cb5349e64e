// Which columns a file of rays has, and what each of them says of its ray.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shapes/solid.hpp"

namespace lostbits::scene::dump {

/// The numbers of a record that mean something to us, in one row: the ray, its range, its solid, its answer, and the
/// matrix that its solid stands under, row by row.
namespace slot {
inline constexpr std::size_t origin = 0, direction = 3, tmax = 6, tmin = 7, solid = 8;
inline constexpr std::size_t t = solid + most_numbers, hit = t + 1, object = t + 2, matrix = t + 3;
inline constexpr std::size_t count = matrix + Affine<double>::numbers;
}  // namespace slot

/// What the columns of a matrix are called, row by row.
inline constexpr std::array<std::string_view, Affine<double>::numbers> matrix_columns{
    "m00", "m01", "m02", "m03", "m10", "m11", "m12", "m13", "m20", "m21", "m22", "m23"};

/// One column of a file.
struct LayoutColumn {
    std::string name;                 ///< as the file has it
    std::optional<std::size_t> slot;  ///< absent: the column is kept as it is, or skipped
    bool skipped = false;             ///< called `_`: it is neither read nor kept
};

/// How a file is laid out: its columns in their order, each number of a record at most once.
class Layout {
public:
    /// Throws what `complain(column, why)` throws: for a ray of fewer than six numbers, a solid or a matrix of fewer
    /// than it has, a sphere's and a box's numbers at once, a number that is there twice, and a name so near to a known
    /// one that is missing that a slip of the fingers explains it. Names are known in upper case too, and with `_hex`
    /// behind them: of `t` and `t_hex` the latter is read and the former kept.
    using Complain = std::function<void(std::size_t column, const std::string& why)>;
    Layout(std::vector<std::string> names, const Complain& complain);

    [[nodiscard]] const std::vector<LayoutColumn>& columns() const { return columns_; }
    [[nodiscard]] bool has(std::size_t slot) const { return places_.at(slot).has_value(); }
    /// The column of a number that is there.
    [[nodiscard]] std::size_t place_of(std::size_t slot) const { return places_.at(slot).value(); }
    /// Of the solid that each record has; nothing where records have none.
    [[nodiscard]] std::optional<Shape> solid() const { return solid_; }
    /// Whether each record has the matrix of its solid.
    [[nodiscard]] bool has_matrix() const { return has(slot::matrix); }
    [[nodiscard]] bool has_answers() const { return has(slot::t) || has(slot::hit); }
    /// Whether the answers are decisions without a t.
    [[nodiscard]] bool decides_only() const { return has(slot::hit) && !has(slot::t); }
    /// The names of the columns that are kept as they are.
    [[nodiscard]] std::vector<std::string> kept() const;

private:
    void find_slots(const Complain& complain);
    void require_whole(const Complain& complain) const;
    [[nodiscard]] bool has_any_of_matrix() const;

    std::vector<LayoutColumn> columns_;
    std::array<std::optional<std::size_t>, slot::count> places_;
    std::optional<Shape> solid_;
};

/// `cx,cy,cz,radius or lox,loy,…`: of each shape.
std::string columns_of_solids();

/// `ox`, `cx`, `lox`: how messages and files call a number of a record; `shape` tells what the solid is,
/// where the number is one of it.
std::string_view name_of_slot(std::size_t slot, std::optional<Shape> shape);

/// The names that stand for several numbers in a row: `origin` or `o` (3), `direction` or `d` (3), `centre` (3),
/// `lo` (3), `hi` (3), `sphere` (4), `box` (6), `ray` (6), `matrix` (12). Empty for other names and other counts.
std::vector<std::string> parts_of(std::string_view name, std::size_t count);

}  // namespace lostbits::scene::dump
