// The colour and the marker of a form: the same in every plot and on the page, whatever is shown beside it.
#pragma once

#include <cstddef>

#include "intersect/table/table.hpp"

namespace lostbits::output::plot {

/// Its place in `look_count`. A form of the catalogue has that of its line there, so that no two that can stand
/// in one plot share one. One from outside has one of those left over, by a hash of its name; where another form from
/// outside was enrolled before it and has that, the next one.
[[nodiscard]] std::size_t form_look(const intersect::table::Intersector& form);

}  // namespace lostbits::output::plot
