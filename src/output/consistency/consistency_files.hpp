// The files of questions put in two ways over a scene: pictures, the contact sheet, one row per pixel, summary.csv.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "measure/consistency/consistency.hpp"
#include "output/pixel/columns.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::consistency {

/// All checks of a scene on one page, and a picture each: checks across; forms and formats down.
class ConsistencyPictures final : public measure::consistency::ConsistencySink {
public:
    /// Opens the sheet and, in the folder `singles`, `<form>.<format>.<check>.png` for each of its cells. `request`
    /// must outlive it.
    ConsistencyPictures(const measure::consistency::ConsistencyRequest& request, const std::filesystem::path& sheet,
                        const std::filesystem::path& singles = {});

    void band(std::size_t row, const measure::consistency::ConsistencyBand& band) override {
        files_.take(row, band, band.y0, band.checks.front().accord.size());
    }
    /// Draws the page and gives the files their final names.
    void finish(const std::vector<measure::consistency::RowChecks>& rows);

private:
    const measure::consistency::ConsistencyRequest& request_;
    pixel::ColumnFiles<measure::consistency::ConsistencyBand> files_;
};

struct ConsistencyFilesOptions {
    std::filesystem::path folder;  ///< of this scene; made if missing
    bool pixels_csv = false;       ///< also one row per pixel
    bool singles = false;          ///< also a picture for each cell of the sheet
};

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
/// The pictures are those of `ConsistencyPictures`; `<form>.<format>.csv` has one row per pixel.
class ConsistencyFiles final : public measure::consistency::ConsistencySink {
public:
    ConsistencyFiles(const measure::consistency::ConsistencyRequest& request, ConsistencyFilesOptions options);

    void band(std::size_t row, const measure::consistency::ConsistencyBand& band) override;
    void finish(const std::vector<measure::consistency::RowChecks>& rows);

private:
    const measure::consistency::ConsistencyRequest& request_;
    ConsistencyFilesOptions options_;
    table::TableFile<CheckRow> table_;
    ConsistencyPictures pictures_;
    std::vector<std::unique_ptr<table::TableFile<AccordPixel>>> pixels_;  ///< of each row, where they are asked for
};

}  // namespace lostbits::output::consistency
