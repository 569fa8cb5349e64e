// Which of several operations that contribute the same is the culprit.
#pragma once

#include <optional>
#include <vector>

#include "measure/blame/attribution.hpp"

namespace lostbits::measure::blame {

/// Contributions are equal where their sizes agree to this part of the larger. They are products of numbers of
/// binary64, good to some 2^-45 of themselves; two that are not equal come nearer than this once in a million rays.
inline constexpr double equal_contributions = 0x1p-20;

/// The live operations of the largest |contribution|, the culprit first; none where nothing was lost. Those nearer to
/// the subject come first (by the most operations in between, so that what is computed from another comes before it),
/// and of equally near ones that which comes first when the formula is read from the answer, operands from left to
/// right. The order of the tape does not matter.
///
/// `below`: only those smaller than that are asked.
std::vector<NodeId> largest_contributions(const Tape& tape, const Attribution& found, std::optional<double> below = {});

/// Whether the error of operation `from` goes through operation i.
bool is_computed_from(const Tape& tape, const Attribution& found, NodeId i, NodeId from);

}  // namespace lostbits::measure::blame
