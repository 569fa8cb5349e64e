// Files of offsets over a scene: pictures, the contact sheet, one row per pixel, and summary.csv. For offsets along an
// axis: a table, and two plots for each row and side.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/offset/along.hpp"
#include "measure/offset/offsets.hpp"
#include "output/pixel/columns.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::offset {

/// `integer` for `offset.integer`.
[[nodiscard]] std::string short_name(const measure::offset::Strategy& strategy);
/// `sphere.half_b.f32.computed`
[[nodiscard]] std::string row_name(const measure::offset::OffsetRow& row);
/// `away from the primitive`, `into the primitive`
[[nodiscard]] std::string in_words(measure::offset::Side side);

struct OffsetPixel {
    const measure::offset::OffsetBand* band;
    std::size_t i;
};

/// A strategy on one side.
struct StrategyRow {
    const measure::offset::OffsetRow* row;
    const measure::offset::OffsetSummary* summary;
    measure::offset::Side side;
    const measure::offset::Strategy* strategy;
    std::size_t place;  ///< index of the strategy
};
/// The columns strategy, side, point, form, format, operations and those of `offset_columns`.
[[nodiscard]] table::Table<StrategyRow> strategy_table();
/// Every strategy on every side.
[[nodiscard]] std::vector<StrategyRow> strategy_rows(const measure::offset::OffsetRequest& request,
                                                     const std::vector<measure::offset::OffsetSummary>& summaries);

/// Opens all files before the work starts. `finish` gives them their final names. One sheet shows all offsets: the
/// smallest safe offset and the strategies across; forms, formats, kinds of points and sides down.
/// `<form>.<format>.<point>.<side>.safe.png` and `….<strategy>.png` are its cells. `<form>.<format>.<point>.csv` has
/// one row per pixel.
class OffsetFiles {
public:
    /// `request` must outlive it.
    OffsetFiles(const measure::offset::OffsetRequest& request, pixel::SceneFilesOptions options);

    void band(std::size_t row, const measure::offset::OffsetBand& band);
    void finish(const std::vector<measure::offset::OffsetSummary>& summaries);

private:
    void add_notes(std::size_t line, const measure::offset::SideSummary& side);

    const measure::offset::OffsetRequest& request_;
    pixel::SceneFilesOptions options_;
    table::TableFile<StrategyRow> table_;
    pixel::ColumnFiles<measure::offset::OffsetBand> pictures_;
    std::vector<std::unique_ptr<table::TableFile<OffsetPixel>>> pixels_;  ///< one per row, if asked for
};

/// Findings for row `r` of a request, one sentence per line. For each side: the largest of the smallest safe offsets,
/// and the strategies that are right for every ray. Then the cheapest strategy that is right on both sides (`none`,
/// which leaves the point as it is, is a strategy too). Empty if no point counts.
[[nodiscard]] std::vector<std::string> row_in_words(const measure::offset::OffsetRequest& request, std::size_t r,
                                                    const measure::offset::OffsetSummary& summary);

/// A strategy at a value on the axis.
struct PlaceRow {
    double place;
    StrategyRow of;
};

/// `along.<axis>.csv` is the summary preceded by the value on the axis. `along.<axis>.<row>.<side>.wrong.png` plots the
/// share of rays that go wrong, and `….size.png` the offsets together with the smallest safe one.
class AlongFiles {
public:
    /// Opens the table. `request`, for the unchanged scene, must outlive it.
    AlongFiles(const std::filesystem::path& folder, const measure::offset::OffsetRequest& request,
               measure::offset::Along along);

    void add(double k, std::vector<measure::offset::OffsetSummary> summaries);
    /// Draws the plots and gives the table its final name.
    void finish();
    [[nodiscard]] const file::DataResource& resource() const { return table_.about(); }

private:
    void plot_wrong(std::size_t row, measure::offset::Side side) const;
    void plot_size(std::size_t row, measure::offset::Side side) const;
    [[nodiscard]] std::filesystem::path file_of(std::size_t row, measure::offset::Side side, const char* what) const;

    std::filesystem::path folder_;
    const measure::offset::OffsetRequest& request_;
    measure::offset::Along along_;
    table::TableFile<PlaceRow> table_;
    std::vector<double> steps_;
    std::vector<std::vector<measure::offset::OffsetSummary>> summaries_;  ///< one per step
};

}  // namespace lostbits::output::offset
