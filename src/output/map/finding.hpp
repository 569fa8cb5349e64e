// The finding of a map: a sentence on its best and its worst form.
#pragma once

#include <string>
#include <vector>

#include "measure/evaluate/map.hpp"

namespace lostbits::output::map {

using measure::evaluate::FormSummary;
using measure::evaluate::MapStudy;

/// A sentence on the best and the worst form in the format of the first tested form: `unified keeps 22 of 24 bits in
/// f32; schoolbook misses 45 % of the true hits`. The best form has the fewest wrong decisions and then keeps the most
/// bits of 99 of 100 hits; the worst form has the most wrong decisions and then keeps the fewest bits. Empty if no form
/// has enough hits.
[[nodiscard]] std::string finding_text(const MapStudy& study, const std::vector<FormSummary>& summaries);

/// The most frequent kind of wrong decision: `misses 45 % of the true hits`, `returns NaN for 3 of 4096 rays`. Empty
/// if all decisions are right.
[[nodiscard]] std::string wrong_decision_text(const FormSummary& summary);

}  // namespace lostbits::output::map
