// Boxes one after another: does it matter whether the closest t so far is passed on as the end of the ray?
#pragma once

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::claim {

/// The share of seeded rays (`scene::box::BoxFamily`'s number of eight adjoining boxes, aimed at their shared edges,
/// from `distance` sizes) on which the nearest t over all boxes differs, or the decision does, when every box is given
/// the closest t so far as tmax.
double differs_with_closest(const evaluate::TestedForm& row, double distance, std::uint64_t seed,
                            truth::TruthLimit limit);

}  // namespace lostbits::measure::claim
