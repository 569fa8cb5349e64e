// Outcomes of rays with several primitives: hits of another primitive than the true one, and the errors that only
// meshes have (crossings that a form misses, counts twice, or puts in the wrong order).
#pragma once

#include <span>

#include "measure/answer/answers.hpp"
#include "measure/answer/outcome.hpp"
#include "measure/columns/columns.hpp"
#include "measure/truth/band.hpp"

namespace lostbits::measure::answer {

/// Answers of a form in a format to a band, judged by a convention.
struct BandAnswers {
    const Answers& answers;
    const truth::FormatInputs& inputs;
    const truth::Band& band;
    intersect::Convention convention;
};

/// Refines the outcomes of a band that has several primitives.
///
/// A hit of another primitive than the true one is an agreed hit where the ray truly meets that primitive at the same
/// t, whatever the shapes: the hit belongs to all primitives that are met first.
///
/// The rest concerns meshes. Neighbours are triangles that share a vertex. A form accepts a triangle if it answers a
/// hit when that triangle alone is tested. Answers read from a file do not say what else is accepted, so only
/// `wrong_neighbour` is found there.
///
/// Triangles are one crossing of the surface if they face the ray with the same side, share a vertex or are truly met
/// at the same t, and are not truly met at two different t. A triangle seen edge-on counts as facing with both sides.
///
/// - `crack`: the form lets light through the surface. All of these hold: the form accepts neither the triangle that
///   the ray truly meets first nor a neighbour of that triangle; the number of crossings that it accepts differs from
///   the true number by an odd number, so that light ends on the wrong side of the surface; the edge of that triangle
///   that the ray passes nearest to belongs to another face too. If two accepted triangles share a vertex and the ray
///   does not truly meet both, they may be one crossing or the two of a fold, so the outcome is not a crack. A form
///   that misses both walls of a mesh, because its outline is shifted or the triangles are not seen at all, has a false
///   miss. A form that misses at the border of a mesh has one too. If the ray truly misses and is stopped, that is a
///   false hit.
/// - `wrong_neighbour`: the first hit of the form is a neighbour of the true triangle, and the ray does not meet it at
///   that t.
/// - `double_hit`: the form accepts the triangle that it hits first and a neighbour of it that is the same crossing. At
///   a fold the ray crosses the surface twice, one crossing after the other, and nothing is counted twice.
/// - `out_of_order`: the form answers a triangle that the ray truly meets, and accepts another one, no neighbour of it,
///   that the ray truly meets before. Both decisions are right, but the computed t of the nearer one is not the
///   smaller.
void refine_outcomes(const BandAnswers& band_answers, const columns::TrueLengths& truth, std::span<Outcome> outcomes);
/// Outcome at a mesh of one ray that truly hits primitive `true_primitive` first. `plain_outcome` is the outcome by the
/// rules for primitives that share no edges.
Outcome outcome_in_mesh(const BandAnswers& band_answers, std::size_t ray, std::int32_t true_primitive,
                        Outcome plain_outcome);

}  // namespace lostbits::measure::answer
