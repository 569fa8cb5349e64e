// Numbers and strings as HTML and JSON hold them.
#pragma once

#include <string>
#include <string_view>

#include "measure/map/map.hpp"

namespace lostbits::output::page {

/// With &, <, > and quotes written as entities.
[[nodiscard]] std::string html(std::string_view text);

/// A JSON string, quotes and all; `<` is written \u003c, so that it may stand inside a script element.
[[nodiscard]] std::string json_text(std::string_view text);

/// The shortest decimal that reads back to the same double, as the CSV has it; null for a NaN, "inf" and "-inf" as
/// strings.
[[nodiscard]] std::string number(double value);

/// A rounded number to look at that carries the exact one: `<data value="12.818665731680333">12.82</data>`; a dash for
/// a NaN.
[[nodiscard]] std::string shown(double value);

/// `sphere.unified.f32`: how the page calls a row.
[[nodiscard]] std::string row_key(const measure::map::MapRow& row);

}  // namespace lostbits::output::page
