// Files of offsets over a scene: pictures, the contact sheet, one row per pixel, and summary.csv. For offsets along an
// axis: a table, and two plots for each offset form (a form in a format, with a kind of point) and side.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "measure/offset/along.hpp"
#include "measure/offset/offsets.hpp"
#include "output/plot/line_plot.hpp"
#include "output/study/study_files.hpp"

namespace lostbits::output::offset {

using measure::offset::OffsetForm;
using measure::offset::OffsetStudy;
using measure::offset::OffsetSummary;
using measure::offset::SceneAxis;
using measure::offset::Side;
using measure::offset::Strategy;

/// Name of a strategy without its prefix: `integer` for `offset.integer`.
[[nodiscard]] std::string short_name(const Strategy& strategy);
/// Name of an offset form, such as `sphere.half_b.f32.computed`.
[[nodiscard]] std::string offset_form_name(const OffsetForm& offset_form);
/// Phrase for a side: `away from the primitive`, `into the primitive`.
[[nodiscard]] std::string side_phrase(Side side);

/// A row of summary.csv: a strategy on one side, for a form, a format and a kind of point.
struct StrategyRow {
    const OffsetForm* offset_form;
    const OffsetSummary* summary;
    Side side;
    const Strategy* strategy;
    std::size_t strategy_index;

    [[nodiscard]] const measure::offset::SideSummary& side_summary() const { return summary->side_summary(side); }
    [[nodiscard]] const measure::offset::StrategySummary& strategy_summary() const {
        return side_summary().strategies[strategy_index];
    }
};
/// A presentation, see output/study/study_files.hpp. One sheet shows all offsets: the smallest safe offset and the
/// strategies across; forms, formats, kinds of points and sides down. `<form>.<format>.<point>.<side>.safe.png` and
/// `….<strategy>.png` are its cells. `<form>.<format>.<point>.csv` has one row per pixel.
struct OffsetPresentation {
    using Study = OffsetStudy;
    using Band = Study::Band;
    using SummaryRow = StrategyRow;
    static constexpr const char* summary_title = "One row per strategy, side, kind of point, form and format";
    static constexpr const char* pixel_title = "One row per pixel with a point that counts";

    /// The columns strategy, side, point, form, format and operations, and the numbers of the strategy.
    static table::Table<StrategyRow> make_summary_table();
    /// One row for every strategy on every side.
    static std::vector<StrategyRow> make_summary_rows(const Study& study, const std::vector<OffsetSummary>& summaries);
    static std::string file_stem(const Study& study, std::size_t form_index);
    static std::size_t pixels(const Band& band) { return band.is_point.size(); }
    static std::vector<pixel::DrawnColumn<Band>> columns(const Study& study);
    static pixel::SheetFile sheet(const Study& study, const std::filesystem::path& file);
    static std::vector<study::Note> notes(const Study& study, const std::vector<OffsetSummary>& summaries);
    static table::Table<study::PixelInBand<Band>> make_pixel_table(const Study& study);
    static bool has_row(const Band& band, std::size_t i) { return band.is_point[i] != 0; }
};

/// Findings for row `form_index` of a study, one sentence per line. For each side: the largest of the smallest safe
/// offsets, and the strategies that are right for every ray. Then the cheapest strategy that is right on both sides
/// (`none`, which leaves the point as it is, is a strategy too). Empty if the summary has no points.
[[nodiscard]] std::vector<std::string> summary_lines(const OffsetStudy& study, std::size_t form_index,
                                                     const OffsetSummary& summary);

/// A row of `along.<axis>.csv`: a strategy at one value on the axis.
struct AlongRow {
    double axis_value;
    StrategyRow strategy_row;
};

/// Writes `along.<axis>.csv`, which is the summary preceded by the value on the axis, and two plots per offset form and
/// side: `along.<axis>.<row>.<side>.wrong.png` with the fraction of rays that go wrong, and `….size.png` with the
/// offsets and the smallest safe offset.
class OffsetsAlongAxisWriter {
public:
    /// Opens the table. `study` is the study of the unchanged scene and must outlive the object.
    OffsetsAlongAxisWriter(const std::filesystem::path& folder, const OffsetStudy& study, SceneAxis axis);

    void add(double axis_value, std::vector<OffsetSummary> summaries);
    /// Draws the plots and gives the table its final name.
    void finish();
    [[nodiscard]] const file::DataResource& resource() const { return table_.about(); }

private:
    void plot_wrong(std::size_t form_index, Side side) const;
    void plot_size(std::size_t form_index, Side side) const;
    [[nodiscard]] plot::LinePlotSpec make_spec(std::size_t form_index, Side side, const std::string& title,
                                               plot::AxisSpec y) const;
    /// The line of a strategy in a plot; without a strategy, the line of the smallest safe offset.
    [[nodiscard]] plot::Series make_series(std::size_t form_index, Side side,
                                           const std::function<double(const measure::offset::SideSummary&)>& value,
                                           const Strategy* strategy = nullptr) const;
    [[nodiscard]] std::filesystem::path picture_path(std::size_t form_index, Side side, const char* kind) const;

    std::filesystem::path folder_;
    const OffsetStudy& study_;
    SceneAxis axis_;
    table::TableFile<AlongRow> table_;
    std::vector<double> axis_values_;                    ///< values on the axis, in the order of `add`
    std::vector<std::vector<OffsetSummary>> summaries_;  ///< one per value on the axis
};

}  // namespace lostbits::output::offset
