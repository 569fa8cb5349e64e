// The numbers of a ray, of a solid and of a pixel as they stand on the command line.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "number/format.hpp"
#include "number/real.hpp"

namespace lostbits::analysis::choice {

/// What an option holds: so many numbers.
struct WantedNumbers {
    const char *option, *what;
    std::size_t count;
    bool special = false;  ///< nan and inf are numbers too
};

/// The numbers between the commas of a ray or a solid, exactly, or rounded to `as`. InputError, which names the option,
/// for what is not a number or is out of the range of `as` (of binary64 without it), and for another count.
std::vector<Real> numbers_of(const std::string& text, const WantedNumbers& wanted, const std::optional<Format>& as);

/// `17,42`: the column and the row. InputError for what is not a pixel.
std::pair<int, int> pixel_named(const std::string& text);

}  // namespace lostbits::analysis::choice
