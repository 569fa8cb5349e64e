// Some floats of an axis as a band of rays: each held against the whole truth, as a map holds its pixels.
#pragma once

#include <vector>

#include "measure/sweep/exhaustive_block.hpp"

namespace lostbits::measure::sweep {

/// As `try_floats`: of a sweep across a mesh. Every float is held against the whole truth of its ray, and its error is
/// the metric `ulp_error`: nothing is left open.
std::vector<FloatTally> try_floats_as_rays(const FloatsOnRay& of, truth::StageCounts& stages);

/// One form at one float.
struct FloatAnswer {
    answer::Outcome outcome = answer::Outcome::agree_miss;
    double t = truth::missing;      ///< the form's answer; NaN where it says miss
    double truth = truth::missing;  ///< t* in the unit of the answer, correctly rounded to binary64; NaN for a miss
    double ulps = truth::missing;   ///< (t − t*)/ulp(t*); NaN unless both hit
};
FloatAnswer answer_at(const ExhaustiveRequest& request, std::size_t ray, std::size_t row, std::uint32_t place);

}  // namespace lostbits::measure::sweep
