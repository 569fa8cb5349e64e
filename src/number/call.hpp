// A step that a form does as a whole: without rounding, in sums as long as they must be, where operations of a format
// leave a ray open. On a tape it is one operation.
#pragma once

#include <cstdint>
#include <string_view>

namespace lostbits {

/// What of an answer a call gives: the decision as 1 or −1, t (−1 of a miss), or the line parameter of one of the two
/// intersections.
enum class CallAnswer : std::uint8_t { decision, t, near, far };

/// The form of this name without rounding, its answer rounded to the format: good to 16u of itself, and a decision
/// right. Its arguments are the numbers of a ray, those of a solid in the order of its keys, and, of the shapes that
/// are told, where the ray ends.
struct Call {
    std::string_view form;
    CallAnswer answer;
};

}  // namespace lostbits
