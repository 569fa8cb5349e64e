// Answers of a form to the rays of a band.
#pragma once

#include <cstdint>
#include <vector>

#include "measure/truth/format_inputs.hpp"

namespace lostbits::measure::answer {

/// Answers of one form in one format to a band: the nearest hit over all primitives, found in the format.
struct Answers {
    std::vector<double> t;
    std::vector<std::uint8_t> hit;
    /// Index of the primitive; −1 where there is no hit. In a distance field, the primitive whose surface is nearest to
    /// the answer.
    std::vector<std::int32_t> primitive;
    /// For each pair of the inputs' `candidates`, 1 if the form claims a hit; empty if the inputs have no candidates.
    std::vector<std::uint8_t> claimed = {};
    std::vector<intersect::MarchRecord> march = {};  ///< one for every ray of a form that marches; else empty
};

/// Evaluates a row of the table. A hit at NaN never replaces another hit. It stays if it is the only one, so that the
/// outcome shows it.
Answers evaluate(const intersect::table::Intersector& form, const truth::FormatInputs& inputs);

}  // namespace lostbits::measure::answer
