// Which of several operations that contribute the same is the culprit.
#pragma once

#include <optional>
#include <vector>

#include "measure/blame/attribution.hpp"

namespace lostbits::measure::blame {

/// Contributions are equal where their sizes agree to this part of the larger. They are sums of products in binary64,
/// far better than this; but two that are equal to first order differ by the relative error of what lies between them,
/// which from binary32 up is mostly less than this. Of 2.9 million rays of the scenes 11 % have equals, and on one in
/// eight of those the equals differ by more than 2^-40.
inline constexpr double equal_contributions = 0x1p-20;

/// The live operations of the largest |contribution|, the culprit first; none where nothing was lost. Those nearer to
/// the subject come first (by the most operations in between, so that what is computed from another comes before it),
/// and of equally near ones that which comes first when the formula is read from the answer, operands from left to
/// right. The order of the tape does not matter.
///
/// `below`: only those smaller than that are asked.
std::vector<NodeId> largest_contributions(const Tape& tape, const Attribution& found, std::optional<double> below = {});

/// The same, but wrong choices that undo each other are passed over while anything else was lost: they took another way
/// to the same value, and rounded nothing. (closest_approach does so on two rays in five.)
std::vector<NodeId> culprit_and_equals(const Tape& tape, const Attribution& found);

/// Whether the error of operation `from` goes through operation i.
bool is_computed_from(const Tape& tape, const Attribution& found, NodeId i, NodeId from);

}  // namespace lostbits::measure::blame
