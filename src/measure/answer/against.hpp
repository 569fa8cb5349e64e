// Compares the answers of two forms to the same ray. This finds differences without the truth.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "measure/answer/answers.hpp"

namespace lostbits::measure::answer {

/// `incomparable_t`: both hit, but their t cannot be compared. Either one of them answers no t, or one takes unit
/// directions and the other does not.
enum class AgainstOutcome : std::uint8_t { both_miss, same_t, other_t, incomparable_t, alone_hits, other_alone_hits };

inline constexpr std::array<std::string_view, 6> against_names{"both_miss",      "same_t",     "other_t",
                                                               "incomparable_t", "alone_hits", "other_alone_hits"};

/// True if the t of both forms have the same meaning: both answer a t, for the same kind of direction.
bool are_comparable(const intersect::Info& a, const intersect::Info& b);

/// Writes the outcome of each ray, as an index into `against_names`, and the distance of the two answers where both
/// hit: (t − t of the other)/ulp_F(t of the other). The distance is 0 for equal t, infinite where they differ and one
/// is infinite or NaN, and NaN where the t are not comparable. Two NaN count as equal. Either span may be empty.
void compare_against(const Answers& answers, const Answers& other, bool comparable, const FloatFormat& format,
                     std::span<double> outcomes, std::span<double> distances);

}  // namespace lostbits::measure::answer
