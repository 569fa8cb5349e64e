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
/// A ray steps through the surface once by all triangles that face it to one side, share a vertex or are truly met at
/// one t, and are not truly met at two. One that is seen from its edge faces to both sides.
/// `crack`: by the claims light ends up on another side of the surface than it truly does: the ray steps through it an
/// odd number of times less or more. Where claimed triangles share a vertex and the ray does not truly meet both, they
/// may be one step or the two of a fold, and nothing is called a crack. It truly meets a triangle first, and the form
/// claims neither that one nor a neighbour; or it meets none, and the form answers a triangle that the ray passes
/// beside. The edge that the ray passes nearest to (farthest outside of, where it passes beside the triangle) has
/// another face across. A form that misses both walls of a mesh, because it sees its outline elsewhere or the triangles
/// not at all, has a false miss; so has one at the border of a mesh, where it may have a false hit as well.
/// `wrong_neighbour`: the first hit of the form is a neighbour of the true triangle, which the ray does not meet at
/// that t. `double_hit`: the form claims the triangle that it hits first and a neighbour of it by which the ray steps
/// through the surface at the same time. At a fold it steps through twice, and nothing is counted twice.
/// `out_of_order`: the form answers a triangle that the ray truly meets, and claims another one, no neighbour of it,
/// that the ray truly meets before: each is decided rightly, but the computed t of the nearer is not the smaller.
void take_apart(const BandAnswers& of, const columns::TrueLengths& truth, std::span<Outcome> outcomes);
/// The latter of one ray that truly hits the solid `truly` first, or none where that is below 0; `before`: as if solids
/// had no edges in common.
Outcome outcome_in_mesh(const BandAnswers& of, std::size_t ray, std::int32_t truly, Outcome before);

}  // namespace lostbits::measure::answer
