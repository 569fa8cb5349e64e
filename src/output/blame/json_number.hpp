// Numbers in JSON, which knows no infinity and no NaN.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "output/file/number_text.hpp"

namespace lostbits::output::blame {

using Json = nlohmann::ordered_json;

/// A number that is infinite or NaN is the string "inf", "-inf" or "nan".
inline Json number(double x) { return std::isfinite(x) ? Json(x) : Json(file::decimal(x)); }

}  // namespace lostbits::output::blame
