// Columns that the tables of several commands share.
#pragma once

#include <optional>
#include <string>

#include "measure/evaluate/evaluate.hpp"
#include "measure/truth/missing.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::table {

/// The columns form and format.
Table<measure::evaluate::TestedForm> make_subject_columns(const std::string& form = "form under test",
                                                          const std::string& format = "format it computes in");

/// Columns with origin and direction as C hexadecimal floats. `meaning` is the meaning of each column.
Table<Ray<double>> make_ray_columns(const std::string& meaning);

/// Columns with the numbers of a primitive of this shape as C hexadecimal floats. `meaning` is the meaning of each
/// column.
Table<Primitive<double>> make_primitive_columns(Shape shape, const std::string& meaning);

/// A part as a fraction of the whole; missing if the whole is 0.
inline std::optional<double> fraction_or_missing(std::uint64_t part, std::uint64_t whole) {
    return file::number_or_missing(measure::truth::fraction(part, whole));
}

/// Returns a function of a row: a percentile of its member `distribution`, or missing if that is empty.
template <class Row>
auto percentile(measure::metric::Distribution Row::*distribution, int percent) {
    return [=](const Row& row) { return file::number_or_missing((row.*distribution).quantile(percent / 100.0)); };
}

}  // namespace lostbits::output::table
