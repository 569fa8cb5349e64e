// Reruns a tape with some operations rounded and the others exact, to find the effect of one operation by itself.
#pragma once

#include <functional>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::attribution {

/// Reruns a tape in numbers of 2048 bits. The results for which `rounds` is true are rounded to their format, and
/// decisions are taken by the values of this run. If all results are rounded, `values` are the values of the tape; if
/// none is, they are the exact values.
struct Rerun {
    std::vector<double> values;  ///< one for each node, to the nearest double; decisions are 1 or 0

    Rerun(const Tape& tape, const std::function<bool(NodeId)>& rounds);
    [[nodiscard]] double operator[](NodeId i) const { return values[static_cast<std::size_t>(i)]; }
};

/// Answer if one operation is treated unlike all others. An attribution divides an error along the path from exact to
/// computed values. A counterfactual is a separate run and need not agree with an attribution.
struct Counterfactual {
    bool hit = false;  ///< the form's decision
    double error = 0;  ///< on a hit: t − t without any rounding
};

struct Counterfactuals {
    Counterfactual only_exact;    ///< only this operation is exact; a choice: only it chooses by exact values
    Counterfactual only_rounded;  ///< only this operation is rounded; a choice: only it chooses as the format did
};

Counterfactuals counterfactuals(const Tape& tape, NodeId operation);

}  // namespace lostbits::measure::attribution
