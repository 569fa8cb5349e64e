#include "output/offset/offset_files.hpp"

#include <fmt/format.h>

#include "output/image/image.hpp"
#include "output/plot/line_plot.hpp"

namespace lostbits::output::offset {

using measure::offset::Along;
using measure::offset::both_sides;
using measure::offset::OffsetRow;
using measure::offset::OffsetStudy;
using measure::offset::OffsetSummary;
using measure::offset::Side;
using measure::offset::SideSummary;

namespace {

std::string subject(const OffsetRow& row, Side side) {
    return fmt::format("{} in {}, {} points, rays {}", row.row.form->info->name, row.row.format.name,
                       name_of(row.point), in_words(side));
}

/// Look of a strategy in every plot: its row in the table of strategies.
std::size_t look_of(const measure::offset::Strategy& strategy) {
    return static_cast<std::size_t>(&strategy - measure::offset::strategies().data());
}

plot::AxisSpec axis_of(Along along) {
    return {std::string(measure::offset::meaning_of(along)), plot::AxisSpec::Scale::log2, {}, {}};
}

}  // namespace

AlongFiles::AlongFiles(const std::filesystem::path& folder, const OffsetStudy& study, Along along)
    : folder_(folder),
      study_(study),
      along_(along),
      table_(folder, fmt::format("along.{}.csv", name_of(along)),
             "One row per value on the axis, strategy, side, kind of point, form and format",
             table::Table<AlongRow>{{std::string(name_of(along)), "number", "",
                                     std::string(measure::offset::meaning_of(along)), &AlongRow::place}}
                 .add(OffsetView::summary_table(), &AlongRow::of)) {}

void AlongFiles::add(double k, std::vector<OffsetSummary> summaries) {
    for (const StrategyRow& row : OffsetView::summary_rows(study_, summaries)) table_.add({k, row});
    steps_.push_back(k);
    summaries_.push_back(std::move(summaries));
}

std::filesystem::path AlongFiles::file_of(std::size_t row, Side side, const char* what) const {
    return folder_ /
           fmt::format("along.{}.{}.{}.{}.png", name_of(along_), row_name(study_.rows[row]), name_of(side), what);
}

void AlongFiles::plot_wrong(std::size_t row, Side side) const {
    plot::LinePlotSpec spec{.title = fmt::format("Rays that go wrong along {}", name_of(along_)),
                            .subtitle = {study_.scene.title, subject(study_.rows[row], side)},
                            .x = axis_of(along_),
                            .y = {"share of rays", plot::AxisSpec::Scale::linear, 0.0, {}, false, false, 1},
                            .series = {}};
    for (std::size_t k = 0; k < study_.strategies.size(); ++k) {
        plot::Series series{.label = short_name(*study_.strategies[k]),
                            .x = steps_,
                            .y = {},
                            .low = {},
                            .high = {},
                            .look = look_of(*study_.strategies[k])};
        for (const auto& step : summaries_) {
            const SideSummary& s = step[row].on(side);
            series.y.push_back(measure::truth::fraction(s.strategies[k].bad, s.rays));
        }
        spec.series.push_back(std::move(series));
    }
    spec.notes = {
        "wrong: a self-hit (by truth or by the form's arithmetic), a lost occluder, or a lost exit",
        "shares are of the points that the form finds; there is none if it misses or names another primitive"};
    plot::write_line_plot(file_of(row, side, "wrong"), spec);
}

void AlongFiles::plot_size(std::size_t row, Side side) const {
    plot::LinePlotSpec spec{.title = fmt::format("Offsets along {}", name_of(along_)),
                            .subtitle = {study_.scene.title, subject(study_.rows[row], side)},
                            .x = axis_of(along_),
                            .y = {"world units", plot::AxisSpec::Scale::log10, {}, {}},
                            .series = {}};
    const auto add = [&](const std::string& label, bool dashed, std::size_t look, const auto& value) {
        plot::Series series{
            .label = label, .x = steps_, .y = {}, .low = {}, .high = {}, .dashed = dashed, .look = look};
        for (const auto& step : summaries_) series.y.push_back(value(step[row].on(side)));
        spec.series.push_back(std::move(series));
    };
    add("smallest safe offset, largest of all points", true, measure::offset::strategies().size(),
        [](const SideSummary& s) { return s.safe.quantile(1); });
    for (std::size_t k = 0; k < study_.strategies.size(); ++k) {
        if (study_.strategies[k]->keeps_point) continue;
        add(short_name(*study_.strategies[k]), false, look_of(*study_.strategies[k]),
            [k](const SideSummary& s) { return s.strategies[k].size.quantile(0.5); });
    }
    spec.notes = {
        "dashed: the largest of the smallest safe offsets of all points; other lines: medians over the points",
        "the dashed line has a gap where no point needs an offset or no offset is safe"};
    plot::write_line_plot(file_of(row, side, "size"), spec);
}

void AlongFiles::finish() {
    for (std::size_t r = 0; r < study_.rows.size(); ++r) {
        for (const Side side : both_sides) {
            plot_wrong(r, side);
            plot_size(r, side);
        }
    }
    table_.close();
}

}  // namespace lostbits::output::offset
