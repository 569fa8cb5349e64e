// What can be said of an error without the exact answer, put on trial where the exact answer is known: random rounding,
// and errors that are taken for independent.
#pragma once

#include <array>

#include "measure/blame/attribution.hpp"

namespace lostbits::measure::stability {

using blame::Attribution;

/// Three runs of a tape in which each result that rounds is rounded up or down by the toss of a coin, and every
/// decision is taken by the values that arise: CESTAC (La Porte and Vignes, 1974), as CADNA has it. The coins follow
/// from the inputs alone.
struct RandomRuns {
    std::array<double, 3> t{};
    std::array<bool, 3> hit{};

    explicit RandomRuns(Tape tape);

    [[nodiscard]] bool agree() const { return hit[0] == hit[1] && hit[1] == hit[2]; }
    /// What CESTAC takes for the answer.
    [[nodiscard]] double mean() const { return (t[0] + t[1] + t[2]) / 3; }
    /// Those of the mean: log2(√3 |mean| / (4.303 σ)), from 0 to p, where all runs hit; 4.303 is Student's factor of
    /// three samples and 95 %. p where they have one t, NaN where a run misses.
    [[nodiscard]] double correct_bits(int precision) const;
};

/// √Σ (adjointᵢ · ulp(vᵢ)/2)² over the operations that round: with λ of these an error that is a sum of independent
/// ones of mean 0 is exceeded with probability 2 exp(−λ²/2) at most (Hoeffding; Higham and Mary, A new approach to
/// probabilistic rounding error analysis, 2019). Of a subject that is a number.
double statistical_bound(const Tape& tape, const Attribution& attribution);

}  // namespace lostbits::measure::stability
