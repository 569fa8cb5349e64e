// The tables of a map: summary.csv (a row per form and format) and the CSV of the pixels of one row.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/map/map.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output::map {

/// Counts and fractions, then mean, p50, p99 and max of |metric| (or the counts of its categories), then the worst ray
/// by |ulp_error| with every number it takes to evaluate it again, in hex. Empty where there is no sample. `shapes` are
/// those of the solids, each once: they name the columns of the worst ray's solid.
struct SummaryTable {
    std::vector<const measure::metric::Metric*> metrics;
    std::vector<Shape> shapes;

    [[nodiscard]] std::vector<file::Column> columns() const;
    /// The cells of one row, from `form` on; the caller ends the row.
    void add(file::CsvWriter& csv, const measure::map::MapRow& row, const measure::map::MapSummary& summary) const;
};

std::vector<file::Column> pixel_columns(const measure::map::MapRequest& request);
void write_pixels(file::CsvWriter& csv, const measure::map::MapRequest& request, const measure::map::MapRow& row,
                  const measure::map::BandResult& result);

}  // namespace lostbits::output::map
