// What the forms answer to the rays of a band.
#pragma once

#include <cstdint>
#include <vector>

#include "measure/truth/format_inputs.hpp"

namespace lostbits::measure::answer {

/// The answers of one form in one format to a band: the nearest hit over all solids, found in the format.
struct Answers {
    std::vector<double> t;
    std::vector<std::uint8_t> hit;
    std::vector<std::int32_t>
        object;  ///< −1 where there is no hit; of a field, the solid whose surface is nearest to the answer
    /// Of each pair of the inputs' `candidates`, whether the form claims a hit; empty where there are none.
    std::vector<std::uint8_t> claimed = {};
    std::vector<intersect::MarchRecord> march = {};  ///< of the forms that march, for every ray; empty for the others
};

/// Evaluates a row of the table. A hit at NaN never beats another hit; alone it stays, for the outcome to show.
Answers evaluate(const intersect::table::Intersector& form, const truth::FormatInputs& inputs);

}  // namespace lostbits::measure::answer
