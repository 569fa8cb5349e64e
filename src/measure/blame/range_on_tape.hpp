// The range of a ray as operations of a tape: what whoever asks a form takes of its answer.
#pragma once

#include <string>
#include <vector>

#include "geometry/range.hpp"
#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::blame {

/// Appends to the tape of a form what `keep_in_range` decides about its answer, by the same function, and makes that
/// the tape's answer. Then a limit that decides is a comparison like any other: it has exact sides, it can be turned,
/// and an operation is the culprit of that. `names` are those of the inputs on the tape; where the ray has a range they
/// get `ray.tmin`. `range` is of the format and in the unit of the form's t, and its end is the one that the form was
/// recorded with.
void put_range_behind(Tape& tape, std::vector<std::string>& names, const intersect::table::Intersector& form,
                      const Format& format, const Range<double>& range);

}  // namespace lostbits::measure::blame
