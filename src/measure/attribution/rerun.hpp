// Reruns a tape with some operations rounded and the others exact, to find the effect of one operation by itself.
#pragma once

#include <functional>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::attribution {

/// Reruns a tape in numbers of 2048 bits. The results for which `is_rounded` is true are rounded to their format, and
/// decisions are made by the values of this run. If all results are rounded, `values` are the values of the tape; if
/// none is, they are the exact values.
struct Rerun {
    std::vector<double> values;  ///< one for each node, to the nearest double; decisions are 1 or 0

    Rerun(const Tape& tape, const std::function<bool(NodeId)>& is_rounded);
    [[nodiscard]] double operator[](NodeId i) const { return values[i]; }
};

/// Answer of a run in which one operation is treated differently from all others. An attribution divides the error of
/// one run among its operations; a counterfactual is another run, so the two need not agree.
struct Counterfactual {
    bool hit = false;  ///< the form's decision
    double error = 0;  ///< for a hit: the t of this run minus the t of the run without any rounding
};

struct Counterfactuals {
    /// Only this operation is exact. If it is a choice, it alone chooses by the exact values.
    Counterfactual only_exact;
    /// Only this operation is rounded. If it is a choice, it alone chooses as the format did.
    Counterfactual only_rounded;
};

Counterfactuals run_counterfactuals(const Tape& tape, NodeId operation);

}  // namespace lostbits::measure::attribution
