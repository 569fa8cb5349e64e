// A segment between two stored points as a ray with an end, in the two ways that renderers write it; and its chord from
// either end.
#pragma once

#include <optional>
#include <span>

#include "measure/consistency/check.hpp"
#include "measure/truth/truth.hpp"
#include "shapes/solid.hpp"

namespace lostbits::measure::consistency {

/// Up to q, or to 1 − 1e-4 of the way, as pbrt's shadow rays end (its ShadowEpsilon).
enum class EndOfSegment : std::uint8_t { whole, shortened };

struct SegmentInTwoWays {
    Ray<double> by_difference;  ///< direction q − p, rounded once
    double difference_end = 1;
    Ray<double>
        by_unit;  ///< direction (q − p)/|q − p| as the format computes it: three products, two sums, root, quotients
    double unit_end = 1;  ///< |q − p| as computed, times the share of the way
};

/// p and q are numbers of the format.
SegmentInTwoWays write_segment(const Vec<double>& p, const Vec<double>& q, const Format& format, EndOfSegment end);

/// Whether a ray that ends there truly meets any of the solids: a sphere at 0 < t < end, a closed (or
/// open) box at 0 ≤ t ≤ end (or <). Of boxes the form is told the end and is held to what it says of touching.
truth::Truth::Decision truly_meets_before(const Ray<double>& ray, double end, std::span<const Solid<double>> solids,
                                          intersect::Convention convention);

/// A chord as it was told from either end: t of the entry and the exit from p, and of the entry and the exit from q.
struct ToldChord {
    double near = 0, far = 0, near_back = 0, far_back = 0;
};

/// A ray from p and one from q, each the other's reverse as far as their stored numbers go, with one solid.
struct EitherEnd {
    Ray<double> forth, back;
    Solid<double> solid;
};

/// By how much t and what is left of the other t fail to add up to the length of the segment, L = 1 or, of the forms
/// that are given unit directions, |q − p| as stored. With δ = near + far′ − L (and far + near′ − L), in units of
/// `ulp`: `apart` is the larger |δ̂| of what was told, `excess` the larger |δ̂ − δ*| against the exact chords, in which
/// δ* is not 0: q plus the reversed direction is not quite the line of p.
struct ChordError {
    double apart = 0, excess = 0;
};

/// `distances`: what was told are distances, not parameters. A near side behind p (or q) is left out: not every form
/// tells it. Both rays truly meet the solid. Nothing where no precision tells.
std::optional<ChordError> chord_error(const EitherEnd& ends, const ToldChord& told, bool distances, double ulp);

}  // namespace lostbits::measure::consistency
