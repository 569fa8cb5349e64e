// Numbers and strings in HTML and JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "output/file/escape.hpp"
#include "output/image/colour.hpp"

namespace lostbits::output::report {

using file::html;

/// Converts prose that users wrote to HTML. Text between backquotes becomes code.
[[nodiscard]] std::string prose_html(std::string_view text);

/// A rounded number for display that carries the exact number: `<data value="12.818665731680333">12.82</data>`. NaN
/// becomes a dash.
[[nodiscard]] std::string number_html(double value);

/// Beginning of a table, up to its first row. The table is in a box of its own, which scrolls sideways if the window is
/// narrower. `attributes` begin with a blank, and `caption` is HTML.
[[nodiscard]] std::string begin_table(const std::vector<std::string>& names, std::string_view attributes = "",
                                      const std::string& caption = "");
inline constexpr const char* end_table = "</tbody></table></div>\n";

/// JSON object whose members keep the order in which they are added.
using Json = nlohmann::ordered_json;

/// Converts a number to JSON: null for NaN, and the strings "inf" and "-inf", because JSON has no such numbers.
[[nodiscard]] Json number_json(double value);

/// `[r,g,b]`
[[nodiscard]] Json colour_json(const image::Rgb8& colour);

/// `{"lo":…,"hi":…,"log2":…,"ticks":[[position,label],…]}`
[[nodiscard]] Json scale_json(const image::ColourScale& scale);

/// Array of `convert(item)` for every item.
template <class Items, class Convert>
[[nodiscard]] Json json_array(const Items& items, const Convert& convert) {
    Json array = Json::array();
    for (const auto& item : items) array.push_back(convert(item));
    return array;
}

/// Writes JSON without spaces. A double is written as the shortest decimal that reads back to it, as in the CSV.
/// nlohmann's dump() does not always write the shortest one, and writes 1 as 1.0. `<` is written as \u003c, so that the
/// text may stand inside a script element.
[[nodiscard]] std::string compact_json(const Json& json);

}  // namespace lostbits::output::report
