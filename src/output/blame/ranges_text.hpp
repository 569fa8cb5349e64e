// A bound over ranges of inputs as a person reads it, and as other programs do.
#pragma once

#include <string>

#include "measure/apriori/ranges.hpp"

namespace lostbits::output::blame {

/// The ranges, how much of them the bound is for, the bound, what rays show of it, and the operations that make it.
std::string ranges_text(const measure::apriori::RangesRequest& request, const measure::apriori::RangesBound& bound);

/// The same in one JSON object; an infinite number is the string "inf".
std::string ranges_json(const measure::apriori::RangesRequest& request, const measure::apriori::RangesBound& bound);

}  // namespace lostbits::output::blame
