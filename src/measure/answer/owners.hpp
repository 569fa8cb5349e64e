// Which primitive a ray is about: the one that it is measured at, and those that own its hit.
#pragma once

#include <cstdint>

#include "measure/truth/band.hpp"

namespace lostbits::measure::answer {

/// The primitive that ray i is measured at: the one that is hit, by the form or else truly (`hit` is below 0 where
/// neither hits); its own where each ray has one; else the first.
inline std::size_t measured_at(const truth::FormatInputs& inputs, std::size_t i, std::int32_t hit) {
    return hit >= 0 ? static_cast<std::size_t>(hit) : inputs.paired ? i : 0;
}

/// Whether ray i truly hits, and that primitive is among the first that it meets. Several are where their t differ by
/// less than the bounds of certified values, 2^-71 of t: all of them own the hit, whatever their kinds. Where each ray
/// has a primitive of its own, no other is asked about.
inline bool meets_first(const truth::Band& band, std::size_t i, std::int32_t primitive,
                        intersect::Convention convention) {
    const truth::Truth first = band.truth(i, convention);
    if (!first.is_hit() || primitive < 0) return false;
    if (primitive == first.object) return true;
    const truth::Truth there = band.truth_of_solid(i, static_cast<std::size_t>(primitive), convention);
    return there.is_hit() && compare(there.t, first.t) == 0;
}

}  // namespace lostbits::measure::answer
