// Columns that tables of several commands have.
#pragma once

#include <string>

#include "measure/evaluate/evaluate.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::table {

/// form and format.
Table<measure::evaluate::TestedForm> subject_columns(const std::string& form = "form under test",
                                                     const std::string& format = "format it computes in");

/// Origin and direction as C hexadecimal floats; `of` is what the ray is of.
Table<Ray<double>> ray_columns(const std::string& of);

/// The numbers of a solid of that shape, in the same way.
Table<Solid<double>> solid_columns(Shape shape, const std::string& of);

}  // namespace lostbits::output::table
