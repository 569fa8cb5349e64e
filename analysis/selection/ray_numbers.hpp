// The numbers of a ray, of a solid and of a pixel, and lengths, as they stand on the command line.
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
#include "shapes/solid.hpp"

namespace lostbits::analysis::selection {

/// What an option holds: so many numbers.
struct WantedNumbers {
    const char *option, *what;
    std::size_t count;
    bool special = false;  ///< nan and inf are numbers too
};

/// What `--sphere`, `--box` and the options of other shapes were given, an option a shape.
class SolidWords {
public:
    [[nodiscard]] std::vector<std::string>& of(Shape shape) { return texts_[static_cast<std::size_t>(shape)]; }
    [[nodiscard]] const std::vector<std::string>& of(Shape shape) const {
        return texts_[static_cast<std::size_t>(shape)];
    }
    /// Declares the options, which the help shows below a heading.
    void add_to(const shell::Command& command, const std::string& heading);
    /// The shapes that are given, in the order of the list.
    [[nodiscard]] std::vector<Shape> shapes() const;
    [[nodiscard]] bool empty() const { return shapes().empty(); }
    /// The solids as they were given, one after the other: their numbers go from 0 in this order.
    [[nodiscard]] std::vector<std::pair<Shape, std::string>> given() const;

private:
    std::array<std::vector<std::string>, shape_rows.size()> texts_;
    std::function<std::vector<std::size_t>()> order_ = [] { return std::vector<std::size_t>(); };
};

/// `--sphere CX,CY,CZ,R or --box LOX,…` where `numbers`, and `--sphere or --box` without.
std::string solid_options(bool numbers, const char* between = " or ");

/// The numbers between the commas of a ray or a solid, exactly, or rounded to `as`. InputError, which names the option,
/// for what is not a number or is out of the range of `as` (of binary64 without it), and for another count.
std::vector<Real> numbers_of(const std::string& text, const WantedNumbers& wanted, const std::optional<Format>& as);

/// Rounded once to binary64; NaN and infinities stay.
double stored_number(const Real& x);

/// A solid by its numbers, `CX,CY,CZ,R`, perhaps with `@` and the twelve of a matrix, row by row, or `@/` and those of
/// a stored inverse; all as `numbers_of` reads them. InputError, which names the option of the shape.
Solid<double> solid_in_words(Shape shape, const std::string& words, const std::optional<Format>& as);

/// `WxH` in pixels. InputError otherwise.
std::pair<int, int> parse_size(const std::string& text);

/// `17,42`: the column and the row. InputError for what is not a pixel.
std::pair<int, int> pixel_named(const std::string& text);

/// `0.001`: so many of the scene's own units of length. `1mm` where `unit` says what that unit
/// is: m, km, cm, mm, um, in or ft. InputError for anything else; of a length with a unit where none is declared it
/// says that scenes do not tell theirs.
double tolerance_in_units(const std::string& text, const std::string& unit);

}  // namespace lostbits::analysis::selection
