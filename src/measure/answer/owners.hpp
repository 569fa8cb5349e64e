// Primitives that a ray is about: the one that it is measured at, and those that own its hit.
#pragma once

#include <cstdint>

#include "measure/truth/band.hpp"

namespace lostbits::measure::answer {

/// The primitive that ray i is measured at. It is the one that is hit, by the form or else by the truth (`hit` < 0 if
/// neither hits); otherwise the ray's own, where each ray has one; otherwise the first.
inline std::size_t measured_at(const truth::FormatInputs& inputs, std::size_t i, std::int32_t hit) {
    return hit >= 0 ? static_cast<std::size_t>(hit) : inputs.paired ? i : 0;
}

/// True if ray i truly hits and meets that primitive first. Several primitives are met first if their t differ by less
/// than the bounds of certified values, 2^-71 of t: all of them own the hit, whatever their shapes. Where each ray has
/// a primitive of its own, no other is tested.
inline bool meets_first(const truth::Band& band, std::size_t i, std::int32_t primitive,
                        intersect::Convention convention) {
    const truth::Truth first = band.truth(i, convention);
    if (!first.is_hit() || primitive < 0) return false;
    if (primitive == first.object) return true;
    const truth::Truth there = band.truth_of_primitive(i, static_cast<std::size_t>(primitive), convention);
    return there.is_hit() && compare(there.t, first.t) == 0;
}

}  // namespace lostbits::measure::answer
