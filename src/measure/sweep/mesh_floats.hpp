// Some thousand floats of an axis across a mesh, tried by every form on one ray: as a map tries its pixels.
#pragma once

#include <vector>

#include "measure/sweep/exhaustive_block.hpp"

namespace lostbits::measure::sweep {

/// What the rows do at these floats, of a sweep that has a mesh: a tally a row. Every float is held against the whole
/// truth of its ray, and its error is the metric `ulp_error`: nothing is left open.
std::vector<FloatTally> try_mesh_floats(const BlockRequest& request, truth::StageCounts& stages);

/// One form at one float of such a sweep.
struct MeshAnswer {
    answer::Outcome outcome = answer::Outcome::agree_miss;
    double t = 0, truth = 0, ulps = 0;  ///< NaN where there is none
};
MeshAnswer mesh_answer_at(const BlockRequest& request, std::size_t row);

}  // namespace lostbits::measure::sweep
