// The tables of a map: summary.csv (a row per form and format) and the CSV of the pixels of one row.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/map.hpp"
#include "output/csv.hpp"

namespace lostbits::output {

/// Counts and fractions, then mean, p50, p99 and max of |metric| over `agree_hit`, then the worst ray by |ulp_error| with
/// every number it takes to evaluate it again, in hex. Empty where there is no sample.
/// `shape` is that of all rows: it names the columns of the worst ray's solid.
std::vector<Column> summary_columns(const std::vector<const Metric*>& metrics, Shape shape);
/// The cells of one row of it, from `form` on; the caller ends the row.
void add_summary(CsvWriter& csv, const MapRow& row, const MapSummary& summary);

std::vector<Column> pixel_columns(const MapRequest& request);
void write_pixels(CsvWriter& csv, const MapRequest& request, const MapRow& row, const BandResult& result);

}  // namespace lostbits::output
