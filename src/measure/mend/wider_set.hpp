// The operations of a tape that must be done wider so that it meets a wish.
#pragma once

#include <cstdint>
#include <vector>

#include "measure/mend/judge.hpp"

namespace lostbits::measure::mend {

/// A set of operations done wider, from which nothing can be taken.
struct WiderSet {
    std::vector<NodeId> operations;  ///< of the form's tape
    Worth worth{};
    std::vector<Worth> without = {};  ///< with each of the operations as it was, the others wider: none meets the wish
    /// No set of so many operations or fewer meets the wish: all were tried. One less than its own size: it is one of
    /// the smallest.
    std::size_t none_of = 0;
};

/// From all operations, with which the wish is met, those are taken away, one after the other, whose loss costs least
/// while it is, until none can be spared; then all smaller sets are tried as far as there are at most `affordable` of
/// one size.
WiderSet smallest_set(const Tape& tape, const FloatFormat& wider, const Worth& with_all, const MendRequest& request,
                      Judge& judge, std::uint64_t affordable);

}  // namespace lostbits::measure::mend
