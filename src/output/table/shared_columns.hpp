// Columns that the tables of several commands share.
#pragma once

#include <string>

#include "measure/evaluate/evaluate.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::table {

/// The columns form and format.
Table<measure::evaluate::TestedForm> subject_columns(const std::string& form = "form under test",
                                                     const std::string& format = "format it computes in");

/// Columns with origin and direction as C hexadecimal floats. `meaning` is the meaning of each column.
Table<Ray<double>> ray_columns(const std::string& meaning);

/// Columns with the numbers of a primitive of this shape as C hexadecimal floats. `meaning` is the meaning of each
/// column.
Table<Primitive<double>> primitive_columns(Shape shape, const std::string& meaning);

}  // namespace lostbits::output::table
