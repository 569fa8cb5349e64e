// What every decision that is not a bool has in common.
#pragma once

#include <concepts>

namespace lostbits {

/// The base of masks: of the three-valued decisions of enclosures, of decisions on a tape, of those of a pack's lanes.
/// An `if`, `?:`, `while`, or `&&` with a bool asks for one answer where there may be none yet, or several: it is told
/// so in one sentence. (The mask of the archetype is no such base: there the question itself must not exist.)
struct NotABool {
    template <std::same_as<bool> Asked>
    explicit operator Asked() const {
        static_assert(!std::same_as<Asked, bool>,
                      "this comparison may have no single answer (an interval, a pack of rays), so it cannot be asked "
                      "by if or ?: - write select(mask, a, b), compute both ways and join masks by && || !");
        return false;
    }
};

}  // namespace lostbits
