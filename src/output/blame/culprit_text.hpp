// The culprit of an explained ray in words.
#pragma once

#include <string>

#include "measure/blame/explanation.hpp"

namespace lostbits::output::blame {

/// Which operation, what became of its rounding, and which others contribute as much.
std::string culprit_sentence(const measure::blame::Explanation& x);

/// What becomes of the answer if the culprit alone did not round, and if it alone did; empty where there is none.
std::string counterfactual_sentence(const measure::blame::Explanation& x);

}  // namespace lostbits::output::blame
