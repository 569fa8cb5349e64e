// Primitives of a ray: the one at which it is measured, and those that it meets first.
#pragma once

#include <cstdint>

#include "measure/truth/band.hpp"

namespace lostbits::measure::answer {

/// Returns the index of the primitive at which ray i is measured. This is `hit_primitive`, the one that the form or
/// else the truth hits. If neither hits (−1), it is the ray's own primitive if each ray has one, and otherwise the
/// first.
inline std::size_t measured_primitive(const truth::FormatInputs& inputs, std::size_t i, std::int32_t hit_primitive) {
    return hit_primitive >= 0 ? static_cast<std::size_t>(hit_primitive) : inputs.is_paired ? i : 0;
}

/// True if ray i truly hits and meets this primitive first. Several primitives are met first if their t differ by less
/// than the bounds of certified values, 2^-71 of t: all of them own the hit, whatever their shapes. Where each ray has
/// a primitive of its own, no other primitive is tested.
inline bool meets_first(const truth::Band& band, std::size_t i, std::int32_t primitive,
                        intersect::Convention convention) {
    const truth::Truth first = band.truth(i, convention);
    if (!first.is_hit() || primitive < 0) return false;
    if (primitive == first.primitive) return true;
    const truth::Truth other = band.truth_of_primitive(i, static_cast<std::size_t>(primitive), convention);
    return other.is_hit() && compare(other.t, first.t) == 0;
}

}  // namespace lostbits::measure::answer
