// The files of offsets over a scene: pictures, the contact sheet, one row per pixel, summary.csv.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "measure/offset/offsets.hpp"
#include "output/file/csv.hpp"
#include "output/file/datapackage.hpp"

namespace lostbits::output::offset {

struct OffsetFilesOptions {
    std::filesystem::path folder;               ///< of this scene; made if missing
    bool pixels_csv = false;                    ///< also one row per pixel
    std::vector<file::DataResource> also = {};  ///< other tables in the folder
};

/// The columns of summary.csv: strategy, side, point, form, format, operations and `offset_columns`.
[[nodiscard]] std::vector<file::Column> offset_summary_columns();
/// `sphere.half_b.f32.computed`
[[nodiscard]] std::string row_name(const measure::offset::OffsetRow& row);
/// `away from the solid`, `into the solid`
[[nodiscard]] std::string in_words(measure::offset::Side side);
/// Adds a row for every strategy to every side, after the cells that stand `before`.
void add_summary_rows(const measure::offset::OffsetRequest& request,
                      const std::vector<measure::offset::OffsetSummary>& summaries, file::CsvWriter& table,
                      const std::vector<file::Cell>& before = {});

/// Opens every file at once, before any work, and gives all their final names in `finish`.
///
/// `<form>.<format>.<point>.<side>.safe.png` is the smallest safe offset of each point, and `….<strategy>.png` what
/// becomes of the rays of a strategy; `<form>.<format>.<point>.csv` has one row per pixel.
class OffsetFiles final : public measure::offset::OffsetSink {
public:
    OffsetFiles(const measure::offset::OffsetRequest& request, const OffsetFilesOptions& options);
    ~OffsetFiles() override;
    OffsetFiles(const OffsetFiles&) = delete;
    OffsetFiles& operator=(const OffsetFiles&) = delete;

    void band(std::size_t row, const measure::offset::OffsetBand& band) override;
    void finish(const std::vector<measure::offset::OffsetSummary>& summaries);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::offset
