// Notes about intersectors of the user whose contract seems to be wrong.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::analysis::selection {

/// A line `FORM FORMAT: text` for each row whose form is not in the catalogue and for which `suspicion` returns a text.
/// It returns an empty text if nothing seems wrong (`measure::contract::suspicion`).
std::vector<std::string> suspicions_of(
    const std::vector<measure::evaluate::TestedForm>& rows,
    const std::function<std::string(const measure::evaluate::TestedForm&)>& suspicion);

}  // namespace lostbits::analysis::selection
