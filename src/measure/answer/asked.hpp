// One ray put to one row of the table, in a format.
#pragma once

#include <optional>

#include "intersect/table/table.hpp"

namespace lostbits::measure::answer {

/// The t that a row answers; nothing where it misses. Inputs are numbers of the format.
std::optional<double> ask_one(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
                              const Solid<double>& solid, double tmax);

}  // namespace lostbits::measure::answer
