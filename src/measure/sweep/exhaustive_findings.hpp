// What an exhaustive sweep has found: onsets that are exact, and what can be said of all floats together.
#pragma once

#include <optional>
#include <vector>

#include "measure/sweep/exhaustive.hpp"

namespace lostbits::measure::sweep {

/// One form at one float.
struct FloatAnswer {
    answer::Outcome outcome;
    float t;                        ///< the form's answer; NaN where it says miss
    double truth = truth::missing;  ///< t* in the unit of the answer, correctly rounded to binary64; NaN for a miss
    double ulps = truth::missing;   ///< (t − t*)/ulp(t*); NaN unless both hit
};
FloatAnswer answer_at(const ExhaustiveRequest& request, std::size_t ray, std::size_t row, std::uint32_t place);

/// By how many u tmax must grow so that no hit is missed for slabs that come apart; 0 where none is, missing for a form
/// that asks no box.
double padding_max(const evaluate::TestedForm& row, const FloatTally& tally);

/// A form on a ray over all floats of a range.
struct RangeFinding {
    std::size_t range, ray, row;
    scene::sweep::FloatRange floats;
    FloatTally tally;  ///< of all of them: as many as were tried, not as many as the ends allow

    /// The float before another in the order of the range; nothing before its first.
    [[nodiscard]] std::optional<std::uint32_t> before(std::uint32_t place) const;
};

/// By row, ray and range.
std::vector<RangeFinding> findings_of(const ExhaustiveRequest& request, const ExhaustiveState& state);

}  // namespace lostbits::measure::sweep
