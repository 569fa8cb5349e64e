// Offsets of a scene in words.
#pragma once

#include <string>
#include <vector>

#include "measure/offset/offsets.hpp"

namespace lostbits::output::offset {

/// What is to be said of row `r` of a request, a sentence a line: for each side the largest of the smallest safe
/// offsets and the strategies that are right for every ray, and the cheapest that is right on both sides (`none` is a
/// strategy too: the point stays). Nothing where no point counts.
[[nodiscard]] std::vector<std::string> row_in_words(const measure::offset::OffsetRequest& request, std::size_t r,
                                                    const measure::offset::OffsetSummary& summary);

}  // namespace lostbits::output::offset
