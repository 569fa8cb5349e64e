// Claims about speed: quotients of rates within one run.
#pragma once

#include "intersect/process/stop_token.hpp"
#include "scene/claim/claims_file.hpp"

namespace lostbits::measure::claim {

/// What a claim of the profile `timing` measures, by its metric:
/// `speed_ratio`: the median over interleaved repetitions of (seconds an item of `over`)/(seconds an item of the
/// kernel); `speedup_per_processor`: the median of (rate of all allowed processors)/(rate of one · their number), 1 is
/// perfect. InputError, with the claim's position, for names that
/// do not exist.
double timed_ratio(const scene::claim::Claim& claim, intersect::process::StopToken stop);

}  // namespace lostbits::measure::claim
