// One ray and one form as a person reads it, and as other programs do.
#pragma once

#include <optional>
#include <string>

#include "measure/blame/explanation.hpp"
#include "output/blame/operation_words.hpp"
#include "output/blame/verdict_text.hpp"

namespace lostbits::output::blame {

/// What it comes to in sentences, the inputs, the samples of a march, and the table of operations with the culprit
/// marked. `all` shows every operation; otherwise those that the answer is computed from and that round, cancel, or
/// have a name, and those that a row names: of an earlier sample of a march their values.
std::string explain_text(const measure::blame::Explanation& x, bool all, const std::optional<MarchEnd>& march = {});

/// What stands below the table, a sentence a line: what the contributions sum to, what is not rounding's, and which
/// decisions rounding changed.
std::string sums_text(const measure::blame::Explanation& x, const OperationWords& words);

/// Whether the problem or the formula is to blame, by the envelope.
std::string verdict(const measure::blame::Explanation& x);

/// Everything in one JSON object. Inputs and results are there as decimals and as hexadecimal floats. A number that is
/// infinite or NaN is the string "inf", "-inf" or "nan"; what there is not (the error of a miss, the culprit where
/// nothing is lost, a direction that was not normalised) is null.
std::string explain_json(const measure::blame::Explanation& x);

/// The live operations as a LaTeX `align*`: cancellations under braces, the culprit in a box. Needs amsmath.
std::string explain_latex(const measure::blame::Explanation& x);

}  // namespace lostbits::output::blame
