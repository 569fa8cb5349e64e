// A segment between two stored points as a ray with an end, written in the two ways that renderers use; and its chord
// from either end.
#pragma once

#include <optional>
#include <span>

#include "measure/consistency/check.hpp"
#include "measure/truth/truth.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::consistency {

/// End of a segment: at q, or at 1 − 1e-4 of the way, as pbrt's shadow rays end (its ShadowEpsilon).
enum class EndOfSegment : std::uint8_t { whole, shortened };

struct SegmentRays {
    Ray<double> by_difference;  ///< direction q − p, rounded once
    double difference_end = 1;
    Ray<double>
        by_unit;  ///< direction (q − p)/|q − p| as the format computes it: three products, two sums, root, quotients
    double unit_end = 1;  ///< |q − p| as computed, times the share of the way
};

/// Writes a segment in both ways. p and q are numbers of the format.
SegmentRays write_segment(const Vec<double>& p, const Vec<double>& q, const Format& format, EndOfSegment end);

/// True decision for a ray with this end and any of the primitives: a sphere counts at 0 < t < end, a closed (or open)
/// box at 0 ≤ t ≤ end (or <). For boxes, whose forms take the end, the convention on touching decides.
truth::Truth::Decision truly_meets_before(const Ray<double>& ray, double end,
                                          std::span<const Primitive<double>> primitives,
                                          intersect::Convention convention);

/// A chord as the form answers it from either end: t of entry and exit from p, and t of entry and exit from q.
struct ChordAnswer {
    double near = 0, far = 0, near_back = 0, far_back = 0;
};

/// A ray from p and one from q, each the other's reverse as far as their stored numbers go, with one primitive.
struct ReversedRays {
    Ray<double> forth, back;
    Primitive<double> primitive;
};

/// Error of t and the remaining part of the other t, whose sum should be the length of the segment. The length L is 1
/// or, for forms that take unit directions, |q − p| as stored. With δ = near + far′ − L (and far + near′ − L), in units
/// of `ulp`: `apart` is the larger |δ̂| of the answers, and `excess` the larger |δ̂ − δ*|, with δ* that of the exact
/// chords. δ* is not 0: q plus the reversed direction is not quite on the line of p.
struct ChordError {
    double apart = 0, excess = 0;
};

/// Computes the chord error. `distances`: the answers are distances, not parameters. A near side behind p (or q) is not
/// used, because not every form answers it. Both rays must truly meet the primitive. Nothing if no precision settles
/// it.
std::optional<ChordError> chord_error(const ReversedRays& ends, const ChordAnswer& answer, bool distances, double ulp);

}  // namespace lostbits::measure::consistency
