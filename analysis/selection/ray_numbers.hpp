// Reads rays, primitives, pixels and lengths from the command line.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/shell/command_line.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::analysis::selection {

/// An option that takes `count` numbers. `expected` completes the message "OPTION VALUE is not …".
struct NumberOption {
    const char *option, *expected;
    std::size_t count;
    bool allows_special = false;  ///< nan and inf are allowed
};

/// The values of `--sphere`, `--box` and so on, one option per shape.
class PrimitiveOptions {
public:
    [[nodiscard]] std::vector<std::string>& values_of(Shape shape) { return texts_[static_cast<std::size_t>(shape)]; }
    [[nodiscard]] const std::vector<std::string>& values_of(Shape shape) const {
        return texts_[static_cast<std::size_t>(shape)];
    }
    /// Declares the options. The help shows them below a heading, which also says how their values are written.
    void add_to(const shell::Command& command, const std::string& heading);
    /// The shapes that are given, in the order of `shape_rows`.
    [[nodiscard]] std::vector<Shape> shapes() const;
    [[nodiscard]] bool empty() const { return shapes().empty(); }
    /// The primitives in the order in which they were given, which is the order of their indices.
    [[nodiscard]] std::vector<std::pair<Shape, std::string>> in_given_order() const;
    /// The options that are given: `--sphere and --box`.
    [[nodiscard]] std::string names() const;

private:
    std::array<std::vector<std::string>, shape_rows.size()> texts_;
    std::function<std::vector<std::size_t>()> order_ = [] { return std::vector<std::size_t>(); };
};

/// The numbers between the commas of a ray or a primitive, exact or, with `format`, rounded to that format. Throws
/// InputError, which names the option, for a part that is not a number or is out of the range of `format` (without it,
/// of binary64), and for a wrong count.
std::vector<Real> parse_numbers(const std::string& text, const NumberOption& wanted,
                                const std::optional<Format>& format);

/// Rounds a number once to binary64; NaN and infinities stay.
double stored_number(const Real& x);

/// Parses a primitive from its numbers, `CX,CY,CZ,R`. They may be followed by `@` and the twelve numbers of a matrix,
/// row by row, or by `@/` and the twelve numbers of a stored inverse. `parse_numbers` reads all these numbers. Throws
/// InputError, which names the option of the shape.
Primitive<double> parse_primitive(Shape shape, const std::string& text, const std::optional<Format>& format);

/// Parses `WxH`, in pixels. Throws InputError for other texts.
std::pair<int, int> parse_size(const std::string& text);

/// Parses `17,42`, the column and the row of a pixel. Throws InputError for other texts.
std::pair<int, int> parse_pixel(const std::string& text);

/// Parses a length, in the scene's unit of length: `0.001`, or `1mm` if `unit` names the scene's unit (m, km, cm, mm,
/// um, in or ft). Throws InputError for other texts, and for a length with a unit if the scene's unit is not given.
double tolerance_in_units(const std::string& text, const std::string& unit);

}  // namespace lostbits::analysis::selection
