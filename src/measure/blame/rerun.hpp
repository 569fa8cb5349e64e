// A tape run again with some of its operations rounded and the others not: what one of them does by itself.
#pragma once

#include <functional>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::blame {

/// A tape run over numbers of 2048 bits: every result that `rounds` says is rounded to its format, and every decision
/// is taken by the values that arise. Where all are rounded these are the tape's; where none are, the exact ones.
struct Rerun {
    std::vector<double> values;  ///< a node each, to the nearest double; decisions 1 or 0

    Rerun(const Tape& tape, const std::function<bool(NodeId)>& rounds);
    [[nodiscard]] double operator[](NodeId i) const { return values[static_cast<std::size_t>(i)]; }
};

/// What becomes of the answer where one operation is treated unlike all others. An attribution shares an error out
/// along the path from exact to computed values; these are two runs, and need not agree with it.
struct Counterfactual {
    bool hit = false;  ///< the form's decision
    double error = 0;  ///< t − t without any rounding, on a hit
};

struct Counterfactuals {
    Counterfactual mended;  ///< this operation alone is not rounded; a choice: it alone chooses as exact values do
    Counterfactual alone;   ///< this operation alone is rounded; a choice: it alone chooses as the format did
};

Counterfactuals counterfactuals(const Tape& tape, NodeId operation);

}  // namespace lostbits::measure::blame
