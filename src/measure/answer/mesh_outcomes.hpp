// Which of several primitives a ray meets; and what only meshes have: crossings that a form does not see, sees twice,
// or puts in the wrong order.
#pragma once

#include <span>

#include "measure/answer/answers.hpp"
#include "measure/answer/outcome.hpp"
#include "measure/columns/columns.hpp"
#include "measure/truth/band.hpp"

namespace lostbits::measure::answer {

/// What a form in a format answered about a band, by a convention.
struct BandAnswers {
    const Answers& answers;
    const truth::FormatInputs& inputs;
    const truth::Band& band;
    intersect::Convention convention;
};

/// Takes hits of other primitives than the truth names apart: where the ray meets them at the same t, whatever their
/// kinds, they are agreed hits, for all that are met first own the hit.
/// And the outcomes of rays at meshes. Neighbours are triangles that share a vertex; a form claims a triangle where it
/// says, asked about that one alone, that the ray hits it. Answers of a file do not say what else is claimed: of them
/// only wrong neighbours are told apart.
///
/// `crack`: the ray truly meets a triangle first, the form claims neither that one nor a neighbour, though the mesh
/// goes on across all of its edges, and of the crossings that the ray truly has it claims an odd number less or more:
/// it leaves a closed mesh that it never entered, or the other way round. A form that misses both walls of a mesh,
/// because it sees its outline elsewhere or the triangles not at all, has a false miss; so has one at the border of a
/// mesh. `wrong_neighbour`: the first hit of the form is a neighbour of the true triangle, which the ray does not meet
/// at that t.
/// `double_hit`: the form claims the triangle that it hits first and a neighbour of it, where the ray crosses the mesh
/// once: it misses one of the two, or meets both at one t; again its crossings are an odd number more or less. At a
/// fold the ray meets both, one after the other, and nothing is counted twice.
/// `out_of_order`: the form answers a triangle that the ray truly meets, and claims another one, no neighbour of it,
/// that the ray truly meets before: each is decided rightly, but the computed t of the nearer is not the smaller.
void take_apart(const BandAnswers& of, const columns::TrueLengths& truth, std::span<Outcome> outcomes);
/// The latter of one ray that truly hits the solid `truly` first; `before`: as if solids had no edges in common.
Outcome outcome_in_mesh(const BandAnswers& of, std::size_t ray, std::int32_t truly, Outcome before);

}  // namespace lostbits::measure::answer
