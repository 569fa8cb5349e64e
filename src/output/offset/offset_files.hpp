// The files of offsets over a scene: pictures, the contact sheet, one row per pixel, summary.csv.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/offset/offsets.hpp"
#include "output/pixel/columns.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::offset {

/// `integer` of `offset.integer`.
[[nodiscard]] std::string short_name(const measure::offset::Strategy& strategy);
/// `sphere.half_b.f32.computed`
[[nodiscard]] std::string row_name(const measure::offset::OffsetRow& row);
/// `away from the solid`, `into the solid`
[[nodiscard]] std::string in_words(measure::offset::Side side);

struct OffsetPixel {
    const measure::offset::OffsetBand* band;
    std::size_t i;
};

/// A strategy to one side.
struct StrategyRow {
    const measure::offset::OffsetRow* row;
    const measure::offset::OffsetSummary* summary;
    measure::offset::Side side;
    const measure::offset::Strategy* strategy;
    std::size_t place;  ///< of the strategy
};
/// strategy, side, point, form, format, operations and `offset_columns`.
[[nodiscard]] table::Table<StrategyRow> strategy_table();
/// Every strategy to every side.
[[nodiscard]] std::vector<StrategyRow> strategy_rows(const measure::offset::OffsetRequest& request,
                                                     const std::vector<measure::offset::OffsetSummary>& summaries);

/// Opens every file at once, before any work, and gives all their final names in `finish`.
///
/// All offsets are on one page: the smallest safe offset and the strategies across; forms, formats, kinds of points and
/// sides down. `<form>.<format>.<point>.<side>.safe.png` and `….<strategy>.png` are its cells, and
/// `<form>.<format>.<point>.csv` has one row per pixel.
class OffsetFiles final : public measure::offset::OffsetSink {
public:
    /// `request` must outlive it.
    OffsetFiles(const measure::offset::OffsetRequest& request, pixel::SceneFilesOptions options);

    void band(std::size_t row, const measure::offset::OffsetBand& band) override;
    void finish(const std::vector<measure::offset::OffsetSummary>& summaries);

private:
    void add_notes(std::size_t line, const measure::offset::SideSummary& side);

    const measure::offset::OffsetRequest& request_;
    pixel::SceneFilesOptions options_;
    table::TableFile<StrategyRow> table_;
    pixel::ColumnFiles<measure::offset::OffsetBand> pictures_;
    std::vector<std::unique_ptr<table::TableFile<OffsetPixel>>> pixels_;  ///< of each row, where they are asked for
};

/// What is to be said of row `r` of a request, a sentence a line: for each side the largest of the smallest safe
/// offsets and the strategies that are right for every ray, and the cheapest that is right on both sides (`none` is a
/// strategy too: the point stays). Nothing where no point counts.
[[nodiscard]] std::vector<std::string> row_in_words(const measure::offset::OffsetRequest& request, std::size_t r,
                                                    const measure::offset::OffsetSummary& summary);

}  // namespace lostbits::output::offset
