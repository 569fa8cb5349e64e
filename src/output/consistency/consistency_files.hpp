// The files of questions put in two ways over a scene: pictures, the contact sheet, one row per pixel, summary.csv.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "measure/consistency/consistency.hpp"
#include "output/pixel/columns.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::consistency {

struct AccordPixel {
    const measure::consistency::ConsistencyBand* band;
    std::size_t i;
};

/// What a check finds of a row.
struct CheckRow {
    const measure::consistency::Check* check;
    const measure::evaluate::TestedForm* row;
    const measure::consistency::CheckSummary* summary;
};

/// Opens every file at once, before any work, and gives all their final names in `finish`.
///
/// All checks are on one page, checks across, forms and formats down; `<form>.<format>.<check>.png` is a cell of it,
/// and `<form>.<format>.csv` has one row per pixel.
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
    std::vector<std::unique_ptr<table::TableFile<AccordPixel>>> pixels_;  ///< of each row, where they are asked for
};

}  // namespace lostbits::output::consistency
