// The functions of a form that need only its recording, so that they are compiled once for all forms.
#pragma once

#include "intersect/table/arithmetics.hpp"

namespace lostbits::intersect::table {

/// Sets the functions of a form that follow from its recording: `record`, `record_all` and `bounded`.
void set_recorders(Intersector& form, const EvaluateRecorded* evaluator);

/// Sets the arithmetics of a form by its recording, which must be one program.
void set_recorded_arithmetics(Intersector& form);

}  // namespace lostbits::intersect::table
