// Writes the tables and plots of offsets along an axis of the scene.
#include "output/offset/offset_files.hpp"

#include <fmt/format.h>

#include "output/image/figure.hpp"

namespace lostbits::output::offset {

using measure::offset::SideSummary;

namespace {

std::string subject_text(const OffsetForm& offset_form, Side side) {
    return fmt::format("{} in {}, {} points, rays {}", offset_form.tested_form.form->info->name,
                       offset_form.tested_form.format.name, name_of(offset_form.point_kind), side_phrase(side));
}

/// Look of a strategy in every plot: its index in the table of strategies. The index after the last one is for the
/// smallest safe offset, which belongs to no strategy.
std::size_t strategy_look(const Strategy* strategy) {
    const auto strategies = measure::offset::strategies();
    return strategy ? static_cast<std::size_t>(strategy - strategies.data()) : strategies.size();
}

}  // namespace

OffsetsAlongAxisWriter::OffsetsAlongAxisWriter(const std::filesystem::path& folder, const OffsetStudy& study,
                                               SceneAxis axis)
    : folder_(folder),
      study_(study),
      axis_(axis),
      table_(folder, fmt::format("along.{}.csv", name_of(axis)),
             "One row per value on the axis, strategy, side, kind of point, form and format",
             table::Table<AlongRow>{
                 {std::string(name_of(axis)), std::string(measure::offset::meaning_of(axis)), &AlongRow::axis_value}}
                 .add(OffsetPresentation::make_summary_table(), &AlongRow::strategy_row)) {}

void OffsetsAlongAxisWriter::add(double axis_value, std::vector<OffsetSummary> summaries) {
    for (const StrategyRow& row : OffsetPresentation::make_summary_rows(study_, summaries))
        table_.add({axis_value, row});
    axis_values_.push_back(axis_value);
    summaries_.push_back(std::move(summaries));
}

std::filesystem::path OffsetsAlongAxisWriter::picture_path(std::size_t form_index, Side side, const char* kind) const {
    return folder_ / fmt::format("along.{}.{}.{}.{}.png", name_of(axis_),
                                 offset_form_name(study_.tested_forms[form_index]), name_of(side), kind);
}

plot::LinePlotSpec OffsetsAlongAxisWriter::make_spec(std::size_t form_index, Side side, const std::string& title,
                                                     plot::AxisSpec y) const {
    return {.title = fmt::format("{} along {}", title, name_of(axis_)),
            .subtitle = {study_.scene.title, subject_text(study_.tested_forms[form_index], side)},
            .x = {.title = std::string(measure::offset::meaning_of(axis_)), .scale = plot::AxisSpec::Scale::log2},
            .y = std::move(y)};
}

plot::Series OffsetsAlongAxisWriter::make_series(std::size_t form_index, Side side,
                                                 const std::function<double(const SideSummary&)>& value,
                                                 const Strategy* strategy) const {
    plot::Series series{.label = strategy ? short_name(*strategy) : "smallest safe offset, largest of all points",
                        .x = axis_values_,
                        .is_dashed = strategy == nullptr,
                        .look = strategy_look(strategy)};
    for (const auto& step : summaries_) series.y.push_back(value(step[form_index].side_summary(side)));
    return series;
}

void OffsetsAlongAxisWriter::plot_wrong(std::size_t form_index, Side side) const {
    auto spec = make_spec(form_index, side, "Rays that go wrong", plot::fraction_axis);
    for (std::size_t k = 0; k < study_.strategies.size(); ++k)
        spec.series.push_back(make_series(
            form_index, side,
            [k](const SideSummary& summary) {
                return measure::truth::fraction(summary.strategies[k].bad_ray_count, summary.ray_count);
            },
            study_.strategies[k]));

    spec.notes = {
        "wrong: a self-hit (by truth or by the form's arithmetic), a lost occluder, or a lost exit",
        "shares are of the points that the form finds; it finds no point if it misses or names another primitive"};
    image::save_figure(picture_path(form_index, side, "wrong"), plot::draw_line_plot(spec));
}

void OffsetsAlongAxisWriter::plot_size(std::size_t form_index, Side side) const {
    auto spec = make_spec(form_index, side, "Offsets", {.title = "world units", .scale = plot::AxisSpec::Scale::log10});

    // The smallest safe offset, and the offsets of the strategies that move the point.
    spec.series = {
        make_series(form_index, side, [](const SideSummary& summary) { return summary.safe_offset.quantile(1); })};
    for (std::size_t k = 0; k < study_.strategies.size(); ++k)
        if (!study_.strategies[k]->keeps_point)
            spec.series.push_back(make_series(
                form_index, side,
                [k](const SideSummary& summary) { return summary.strategies[k].offset_size.quantile(0.5); },
                study_.strategies[k]));

    spec.notes = {
        "dashed: the largest of the smallest safe offsets of all points; other lines: medians over the points",
        "the dashed line has a gap where no point needs an offset or no offset is safe"};
    image::save_figure(picture_path(form_index, side, "size"), plot::draw_line_plot(spec));
}

void OffsetsAlongAxisWriter::finish() {
    for (std::size_t r = 0; r < study_.tested_forms.size(); ++r) {
        for (const Side side : measure::offset::both_sides) {
            plot_wrong(r, side);
            plot_size(r, side);
        }
    }
    table_.close();
}

}  // namespace lostbits::output::offset
