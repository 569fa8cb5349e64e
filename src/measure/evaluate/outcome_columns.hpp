// What became of many rays at once.
#pragma once

#include "measure/answer/mesh_outcomes.hpp"
#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::evaluate {

/// Where the outcomes of a band go: as many of each as rays.
struct OutcomeColumns {
    std::vector<answer::Outcome>& outcomes;
    std::vector<double>& measured;  ///< the answers of the correct hits, NaN elsewhere
};

/// The outcome of every ray, counted in `summary` too. A form that does not tell t claims no hit at NaN, and on which
/// solid it hits nobody knows.
void find_outcomes(const answer::BandAnswers& of, const columns::TrueLengths& truth, bool tells_t,
                   const OutcomeColumns& out, FormSummary& summary);

}  // namespace lostbits::measure::evaluate
