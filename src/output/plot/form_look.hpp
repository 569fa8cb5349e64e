// The look of a form: its colour and marker, which are the same in every plot and on the page, whatever else is shown.
#pragma once

#include <cstddef>

#include "intersect/table/table.hpp"

namespace lostbits::output::plot {

/// Index of the form's look among `look_count`. A form of the catalogue has the look of its line there, so no two forms
/// that can appear in one plot share a look. A form from outside gets one of the remaining looks, by a hash of its
/// name; if an earlier form from outside has that look, it gets the next one.
[[nodiscard]] std::size_t form_look(const intersect::table::Intersector& form);

}  // namespace lostbits::output::plot
