// Missing numbers. Missing, zero and undefined are three things: a number that could not be measured is NaN, and tables
// leave it out.
#pragma once

#include <cstdint>
#include <limits>

namespace lostbits::measure::truth {

inline constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// `part` over `whole`; missing if `whole` is 0.
inline double fraction(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? missing : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace lostbits::measure::truth
