// Two forms on the same ray, held against each other: nobody has to know the truth to see that they differ.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "measure/answer/answers.hpp"

namespace lostbits::measure::answer {

/// `incomparable_t` where both hit and their t cannot be compared: one tells none, or one gets unit directions and the
/// other does not.
enum class Against : std::uint8_t { both_miss, same_t, other_t, incomparable_t, alone_hits, other_alone_hits };

inline constexpr std::array<std::string_view, 6> against_names{"both_miss",      "same_t",     "other_t",
                                                               "incomparable_t", "alone_hits", "other_alone_hits"};

/// Whether the two t mean the same.
bool are_comparable(const intersect::Info& a, const intersect::Info& b);

/// What became of each ray, as a place in `against_names`, and by how much the answers are apart where both hit:
/// (t − t of the other)/ulp_F(t of the other); 0 for the same number, infinite where one is infinite or NaN alone, NaN
/// where not both tell one. Two NaN are the same. Either span may be empty.
void compare_against(const Answers& answers, const Answers& other, bool comparable, const FloatFormat& format,
                     std::span<double> which, std::span<double> apart);

}  // namespace lostbits::measure::answer
