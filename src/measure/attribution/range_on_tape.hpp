// Records the checks of a ray's range [tmin, tmax] on a tape, after the operations of the form.
#pragma once

#include <string>
#include <vector>

#include "geometry/range.hpp"
#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::attribution {

/// Appends to the tape of a form the comparisons by which `in_range` accepts or rejects its answer, and makes their
/// result the tape's answer. Comparisons with tmin and tmax can then be analysed like those of the form: both sides
/// have exact values, rounding can reverse the result, and an operation can be named as the culprit. `names` are the
/// names of the tape's inputs; if the ray has a range, `ray.tmin` is added. `ray_range` is in the format and in the
/// unit of the form's t. Its end must be the end with which the form was recorded.
void append_range_checks(Tape& tape, std::vector<std::string>& names, const intersect::table::Intersector& form,
                         const Format& format, const Range<double>& ray_range);

}  // namespace lostbits::measure::attribution
