// Numbers and strings as HTML holds them.
#pragma once

#include <string>
#include <string_view>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::output::page {

/// With &, <, > and quotes written as entities.
[[nodiscard]] std::string html(std::string_view text);

/// A rounded number to look at that carries the exact one: `<data value="12.818665731680333">12.82</data>`; a dash for
/// a NaN.
[[nodiscard]] std::string shown(double value);

}  // namespace lostbits::output::page
