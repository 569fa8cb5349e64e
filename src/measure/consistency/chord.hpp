// Both places where a line meets a solid, over any enclosure, and by how much a chord differs from either end.
#pragma once

#include <optional>

#include "shapes/solid.hpp"

namespace lostbits::measure::consistency {

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
