// Files of a consistency run, which asks the same question in two ways at every pixel of a scene: pictures, the contact
// sheet, one row per pixel, and summary.csv.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "measure/consistency/consistency.hpp"
#include "output/pixel/columns.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::consistency {

/// A pixel of a band, for the table of pixels.
struct AccordPixel {
    const measure::consistency::ConsistencyBand* band;
    std::size_t i;
};

/// Result of a check for a form in a format.
struct CheckRow {
    const measure::consistency::Check* check;
    const measure::evaluate::TestedForm* row;
    const measure::consistency::CheckSummary* summary;
};

/// Opens all files before the work starts. `finish` gives them their final names.
///
/// One sheet shows all checks: checks across, forms and formats down. `<form>.<format>.<check>.png` is one of its
/// cells. `<form>.<format>.csv` has one row per pixel.
class ConsistencyFiles {
public:
    /// `request` must outlive it.
    ConsistencyFiles(const measure::consistency::ConsistencyRequest& request, pixel::SceneFilesOptions options);

    void band(std::size_t row, const measure::consistency::ConsistencyBand& band);
    void finish(const std::vector<measure::consistency::RowChecks>& rows);

private:
    const measure::consistency::ConsistencyRequest& request_;
    pixel::SceneFilesOptions options_;
    table::TableFile<CheckRow> table_;
    pixel::ColumnFiles<measure::consistency::ConsistencyBand> pictures_;
    std::vector<std::unique_ptr<table::TableFile<AccordPixel>>> pixels_;  ///< one per row, if asked for
};

}  // namespace lostbits::output::consistency
