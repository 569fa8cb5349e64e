// JSON files. Their numbers may be infinite or NaN, and their text may hold bytes that are not UTF-8.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "output/file/number_text.hpp"

namespace lostbits::output::file {

/// JSON whose members stay in the order in which they are added.
using OrderedJson = nlohmann::ordered_json;

/// A number as JSON; the string "inf", "-inf" or "nan" if it is infinite or NaN.
inline OrderedJson json_number(double x) { return std::isfinite(x) ? OrderedJson(x) : OrderedJson(decimal(x)); }

/// Text of a JSON file: indented by two blanks per level, with bytes that are not UTF-8 replaced.
inline std::string json_text(const OrderedJson& json) {
    return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace lostbits::output::file
