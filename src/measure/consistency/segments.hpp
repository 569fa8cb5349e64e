// Segments between two stored points: as a ray with an end, written in the two ways that renderers use, and as a pair
// of rays from either end.
#pragma once

#include <optional>
#include <span>

#include "measure/consistency/check.hpp"
#include "measure/truth/truth.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::consistency {

/// End of a segment: at q, or after 1 − 1e-4 of the way to q, like pbrt's shadow rays (ShadowEpsilon).
enum class SegmentEnd : std::uint8_t { whole, shortened };

struct SegmentRays {
    Ray<double> by_difference;  ///< direction q − p, rounded once
    double difference_end = 1;
    /// Direction (q − p)/|q − p| as the format computes it: three products, two sums, root, quotients.
    Ray<double> by_unit;
    double unit_end = 1;  ///< |q − p| as computed, times the fraction of the way
};

/// Writes a segment in both ways. p and q are numbers of the format.
SegmentRays write_segment(const Vec<double>& p, const Vec<double>& q, const Format& format, SegmentEnd end);

/// Decides exactly whether a ray with this end meets any of the primitives. A sphere counts at 0 < t < end. A box
/// counts at 0 ≤ t ≤ end if it is closed, and at 0 < t < end if it is open; the convention on touching says which it
/// is.
truth::Truth::Decision truly_meets_before(const Ray<double>& ray, double end,
                                          std::span<const Primitive<double>> primitives,
                                          intersect::Convention convention);

/// Answers of a form for a chord from either end: t of entry and exit on the ray from p, then on the ray from q.
struct ChordAnswer {
    double near = 0, far = 0, near_back = 0, far_back = 0;
};

/// A ray from p, the reversed ray from q, and one primitive. `back` has exactly the negated direction. It starts at q,
/// which is p + d rounded.
struct ReversedRays {
    Ray<double> forth, back;
    Primitive<double> primitive;
};

/// Errors of two sums of t. Along a chord, near + far′ and far + near′ should each be L, the segment's length. Primed
/// values are from the ray that starts at q. L is 1 or, for forms that take unit directions, |q − p| as stored. Let δ
/// be the sum minus L, in units of `ulp`: δ̂ for the answers and δ* for the exact chords. `apart` is the larger |δ̂|,
/// and `excess` the larger |δ̂ − δ*|. δ* is not 0, because q plus the reversed direction is not quite p.
struct ChordError {
    double apart = 0, excess = 0;
};

/// Computes the chord error. `are_distances` is true if the answers are distances, not parameters. A near side behind p
/// (or q) is not used, because not every form answers it. Both rays must truly meet the primitive. Returns nothing if
/// no precision is enough.
std::optional<ChordError> compute_chord_error(const ReversedRays& rays, const ChordAnswer& answer, bool are_distances,
                                              double ulp);

}  // namespace lostbits::measure::consistency
