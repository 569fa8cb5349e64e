// Claims about what is chosen for a scene: which forms meet a wish there, which of them is the cheapest, and times over
// times on the scene's own rays.
#pragma once

#include "measure/claim/claim.hpp"

namespace lostbits::measure::claim {

/// What a claim with a `choice` measures, by its metric; each is of the claim's form in its format, in the widest
/// registers that are in use:
/// `meets`: 1 where it meets the wish, else 0;
/// `others_that_meet`: how many of the other forms that fit the scene do, in the choice's formats, each of them
/// counted; `chosen`: 1 where it is the cheapest of all that do, else 0; `time_ratio`: the median over interleaved
/// repetitions of (its seconds a ray and solid)/(those of `over`).
/// InputError, with the claim's position, for names that do not exist.
double chosen_value(const scene::claim::Claim& claim, const ClaimRequest& run);

}  // namespace lostbits::measure::claim
