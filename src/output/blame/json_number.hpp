// Numbers in JSON, which knows no infinity and no NaN.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "output/file/number_text.hpp"

namespace lostbits::output::blame {

/// A number that is infinite or NaN is the string "inf", "-inf" or "nan".
inline nlohmann::ordered_json number(double x) {
    return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(file::decimal(x));
}

}  // namespace lostbits::output::blame
