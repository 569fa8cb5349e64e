// Records the range of a ray as operations of a tape: it decides which of a form's answers count.
#pragma once

#include <string>
#include <vector>

#include "geometry/range.hpp"
#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::attribution {

/// Appends to the tape of a form the decisions of `keep_in_range` about its answer, by the same function, and makes the
/// result the tape's answer. A limit of the range is then a comparison like any other: it has exact sides, rounding can
/// turn it, and an operation is the culprit of that. `names` are those of the inputs on the tape; if the ray has a
/// range, `ray.tmin` is added. `range` is in the format and in the unit of the form's t, and its end is the one that
/// the form was recorded with.
void put_range_behind(Tape& tape, std::vector<std::string>& names, const intersect::table::Intersector& form,
                      const Format& format, const Range<double>& range);

}  // namespace lostbits::measure::attribution
