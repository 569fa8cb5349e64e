// Writes the pictures, tables and sentences of offsets over a scene.
#include "output/offset/offset_files.hpp"

#include <fmt/format.h>

#include <cmath>

#include "measure/offset/offsets.hpp"
#include "output/file/number_text.hpp"
#include "output/map/form_names.hpp"
#include "output/table/shared_columns.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::offset {

using measure::answer::Outcome;
using measure::offset::both_sides;
using measure::offset::Fault;
using measure::offset::OffsetBand;
using pixel::colour_of;
using pixel::DrawnColumn;
using pixel::PixelValue;
using table::Table;

namespace {

constexpr const char* safe_unit = "ulps of the largest coordinate";

/// Category of pixels without a point from which rays leave: form and truth do not hit the same primitive, or the point
/// is not finite.
const pixel::Category no_point_category{"no point that counts", colour_of(Outcome::agree_miss)};

/// Result of a strategy at a point: the first in this list that applies to one of the rays.
enum class StrategyResult : std::uint8_t { no_point, self_hit, jumps_past, form_fault, wrong_side, all_right };
pixel::Look make_strategy_result_look() {
    return {{no_point_category,
             {"self-hit by truth", colour_of(Outcome::false_miss)},
             {"jumps past a neighbour, or past its own far side", colour_of(Outcome::unresolved)},
             {"self-hit or lost by the form's arithmetic alone", colour_of(Outcome::false_hit)},
             {"starts on the wrong side, without harm", colour_of(Outcome::wrong_primitive)},
             {"every ray is right", colour_of(Outcome::agree_hit)}}};
}

StrategyResult find_strategy_result(const OffsetBand& band, std::size_t pixel, Side side, std::size_t strategy) {
    if (band.is_point[pixel] == 0) return StrategyResult::no_point;
    const measure::offset::StrategyAtPoint& faults = band.at(pixel, side, strategy);
    if (faults[Fault::self_hit] > 0) return StrategyResult::self_hit;
    if (faults[Fault::lost_occluder] + faults[Fault::begins_in_neighbour] + faults[Fault::lost_exit] +
            faults[Fault::not_finite] >
        0)
        return StrategyResult::jumps_past;
    if (faults[Fault::self_hit_by_form] + faults[Fault::lost_exit_by_form] > 0) return StrategyResult::form_fault;
    return faults[Fault::wrong_side] > 0 ? StrategyResult::wrong_side : StrategyResult::all_right;
}

/// Colours of the map of smallest safe offsets: the scale, and the categories of pixels that are not on the scale.
pixel::Look make_safe_offset_look() {
    return {{no_point_category,
             // Differs from the colour of `every ray is right` in other cells of the sheet.
             {"needs no offset", colour_of(Outcome::out_of_order)},
             {"no offset is safe", colour_of(Outcome::not_a_number)},
             {""}},
            pixel::magnitude_scale(0x1p-2, 0x1p14),
            safe_unit};
}

/// Categories of `make_safe_offset_look`.
enum class SafeOffsetKind : std::uint8_t { no_point, none_needed, none_safe, has_value };

PixelValue safe_offset_pixel(const OffsetBand& band, std::size_t pixel, Side side) {
    const auto category = [](SafeOffsetKind kind) { return static_cast<std::size_t>(kind); };
    if (band.is_point[pixel] == 0) return {category(SafeOffsetKind::no_point)};
    const double offset = band.sides[pixel][static_cast<std::size_t>(side)].safe_offset;
    if (offset == 0) return {category(SafeOffsetKind::none_needed)};
    return std::isfinite(offset) ? PixelValue{category(SafeOffsetKind::has_value), offset / band.ulp[pixel]}
                                 : PixelValue{category(SafeOffsetKind::none_safe)};
}

/// Line of the sheet that shows a side of a row of the study.
std::size_t sheet_line(std::size_t form_index, Side side) { return 2 * form_index + static_cast<std::size_t>(side); }

/// Adds the notes below the cells of a line of the sheet.
void add_notes(const OffsetStudy& study, std::size_t line, const measure::offset::SideSummary& side,
               std::vector<study::Note>& notes) {
    if (side.safe_offset.count() > 0)
        notes.push_back(
            {{0, line},
             fmt::format("p50 {}, max {}\n(world units)", file::short_decimal(side.safe_offset.quantile(0.5), 2),
                         file::short_decimal(side.safe_offset.quantile(1), 2))});
    for (std::size_t k = 0; k < study.strategies.size(); ++k) {
        const auto& strategy = side.strategies[k];
        std::string note = side.ray_count > 0 && strategy.bad_ray_count == 0
                               ? "every ray right"
                               : pixel::fraction_text(strategy.bad_ray_count, side.ray_count) + " of rays wrong";
        if (const double size_ratio = strategy.size_ratio.quantile(0.5); size_ratio > 0)
            note += fmt::format("\n{} x needed", file::short_decimal(size_ratio, 3));
        notes.push_back({{k + 1, line}, std::move(note)});
    }
}

/// `sphere.half_b in f32, computed points`
std::string points_text(const OffsetForm& offset_form) {
    return fmt::format("{} in {}, {} points", offset_form.tested_form.form->info->name,
                       offset_form.tested_form.format.name, name_of(offset_form.point_kind));
}

/// Column of the results of one strategy on one side.
DrawnColumn<OffsetBand> make_strategy_column(const OffsetStudy& study, std::size_t form_index, Side side,
                                             std::size_t strategy_index, std::shared_ptr<const pixel::Look> look) {
    const Strategy& strategy = *study.strategies[strategy_index];
    return {
        {.file = fmt::format("{}.{}.{}.png", offset_form_name(study.tested_forms[form_index]), name_of(side),
                             short_name(strategy)),
         .title = fmt::format("{} {}", strategy.name, side_phrase(side)),
         .subtitle = {points_text(study.tested_forms[form_index]), fmt::format("the new origin: {}", strategy.title)},
         .look = std::move(look),
         .sheet_positions = {{strategy_index + 1, sheet_line(form_index, side)}}},
        form_index,
        pixel::make_draw_function<OffsetBand>([side, strategy_index](const OffsetBand& band, std::size_t i) {
            return PixelValue{static_cast<std::size_t>(find_strategy_result(band, i, side, strategy_index))};
        })};
}

/// Column of the smallest safe offsets on one side.
DrawnColumn<OffsetBand> make_safe_offset_column(const OffsetStudy& study, std::size_t form_index, Side side,
                                                std::shared_ptr<const pixel::Look> look) {
    return {{.file = fmt::format("{}.{}.safe.png", offset_form_name(study.tested_forms[form_index]), name_of(side)),
             .title = fmt::format("The smallest safe offset {}", side_phrase(side)),
             .subtitle = {points_text(study.tested_forms[form_index]),
                          "colour: the smallest offset along the normal for which every ray is right by truth, clamped "
                          "at both ends of the bar"},
             .look = std::move(look),
             .sheet_positions = {{0, sheet_line(form_index, side)}}},
            form_index,
            pixel::make_draw_function<OffsetBand>(
                [side](const OffsetBand& band, std::size_t i) { return safe_offset_pixel(band, i, side); })};
}

}  // namespace

std::string short_name(const Strategy& strategy) {
    return std::string(strategy.name.substr(strategy.name.find('.') + 1));
}

std::string offset_form_name(const OffsetForm& offset_form) {
    return fmt::format("{}.{}", map::tested_form_name(offset_form.tested_form), name_of(offset_form.point_kind));
}

std::string OffsetPresentation::file_stem(const OffsetStudy& study, std::size_t form_index) {
    return offset::offset_form_name(study.tested_forms[form_index]);
}

std::string side_phrase(Side side) { return side == Side::outside ? "away from the primitive" : "into the primitive"; }

std::vector<DrawnColumn<OffsetBand>> OffsetPresentation::columns(const OffsetStudy& study) {
    const auto result_look = std::make_shared<const pixel::Look>(make_strategy_result_look());
    const auto safe_offset_look = std::make_shared<const pixel::Look>(make_safe_offset_look());
    std::vector<DrawnColumn<OffsetBand>> columns;
    for (std::size_t r = 0; r < study.tested_forms.size(); ++r) {
        for (const Side side : both_sides) {
            for (std::size_t k = 0; k < study.strategies.size(); ++k)
                columns.push_back(make_strategy_column(study, r, side, k, result_look));
            columns.push_back(make_safe_offset_column(study, r, side, safe_offset_look));
        }
    }
    return columns;
}

pixel::SheetFile OffsetPresentation::sheet(const OffsetStudy& study, const std::filesystem::path& file) {
    image::SheetSpec spec{
        .title = study.scene.title,
        .subtitle = {fmt::format("{}, {} x {} pixels: outcomes of rays that leave the points that a form finds",
                                 study.scene.id, study.scene.width, study.scene.height),
                     "first column: the smallest safe offset, in ulps of the largest coordinate; then each strategy, "
                     "with its share of rays that go wrong"},
        .column_labels = {"smallest safe"},
        .scales = {*make_safe_offset_look().scale},
        .bar_label = safe_unit,
        .shows_categories = true};

    // A column for each strategy, and a line for each row and side.
    for (const Strategy* strategy : study.strategies) spec.column_labels.push_back(short_name(*strategy));
    for (const OffsetForm& offset_form : study.tested_forms) {
        for (const Side side : both_sides)
            spec.row_labels.push_back(fmt::format("{} {} {} {}", map::short_name(*offset_form.tested_form.form->info),
                                                  offset_form.tested_form.format.name, name_of(offset_form.point_kind),
                                                  name_of(side)));
    }
    return {file, std::move(spec)};
}

std::vector<study::Note> OffsetPresentation::notes(const OffsetStudy& study,
                                                   const std::vector<OffsetSummary>& summaries) {
    std::vector<study::Note> notes;
    for (std::size_t r = 0; r < summaries.size(); ++r)
        for (const Side side : both_sides)
            add_notes(study, sheet_line(r, side), summaries[r].side_summary(side), notes);
    return notes;
}

Table<study::PixelInBand<OffsetBand>> OffsetPresentation::make_pixel_table(const OffsetStudy& study) {
    using R = study::PixelInBand<OffsetBand>;
    Table<R> table = study::position_columns<OffsetBand>();
    table.add({"object", "primitive that the ray leaves, from 0", [](const R& r) { return r.band->primitive[r.i]; }});
    for (const Side side : both_sides) {
        // Values of all rays of a side.
        const std::string name(name_of(side));
        using P = measure::offset::SideOfPoint;
        table.add<P>(
            {{"rays_" + name, "rays " + side_phrase(side), &P::ray_count},
             {"safe_" + name, "world units", "smallest safe offset; inf if no offset is safe", &P::safe_offset},
             {"quiet_" + name, "world units",
              "smallest offset that is safe by truth and by the form's arithmetic; inf if none is", &P::quiet_offset}},
            [side](const R& r) -> const P& { return r.band->sides[r.i][static_cast<std::size_t>(side)]; });

        // Faults of each strategy.
        for (std::size_t k = 0; k < study.strategies.size(); ++k) {
            const Strategy& strategy = *study.strategies[k];
            const std::string rays = "rays of " + std::string(strategy.name);
            table.add({{short_name(strategy) + "_self_hits_" + name, rays + " that by truth hit what they leave",
                        [side, k](const R& r) { return r.band->at(r.i, side, k)[Fault::self_hit]; }},
                       {short_name(strategy) + "_bad_" + name,
                        rays + " with any fault except a start on the wrong side, which alone does no harm",
                        [side, k](const R& r) { return r.band->at(r.i, side, k).bad_ray_count; }}});
        }
    }
    return table;
}

std::vector<StrategyRow> OffsetPresentation::make_summary_rows(const OffsetStudy& study,
                                                               const std::vector<OffsetSummary>& summaries) {
    std::vector<StrategyRow> rows;
    for (std::size_t r = 0; r < study.tested_forms.size(); ++r)
        for (const Side side : both_sides)
            for (std::size_t k = 0; k < study.strategies.size(); ++k)
                rows.push_back({&study.tested_forms[r], &summaries[r], side, study.strategies[k], k});
    return rows;
}

namespace {

/// Names of the strategies that are right for every ray of a side: `none, integer`, or `no strategy`.
std::string faultless_strategies(const OffsetStudy& study, const measure::offset::SideSummary& side_summary) {
    std::string names;
    for (std::size_t k = 0; k < study.strategies.size(); ++k) {
        if (side_summary.strategies[k].bad_ray_count > 0) continue;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", short_name(*study.strategies[k]));
    }
    return names.empty() ? "no strategy" : names;
}

/// The largest of the smallest safe offsets of a side, and how many points have none.
std::string safe_offset_text(const measure::offset::SideSummary& side_summary) {
    const double largest = side_summary.safe_offset.quantile(1);
    if (std::isnan(largest))
        return fmt::format("no offset is safe at any of {}",
                           text::count_with_noun(side_summary.never_safe_point_count, "point"));
    return fmt::format("smallest safe offset up to {}{}", file::short_decimal(largest, 3),
                       side_summary.never_safe_point_count == 0 ? ""
                       : side_summary.never_safe_point_count == 1
                           ? " (1 point has none)"
                           : fmt::format(" ({} points have none)", side_summary.never_safe_point_count));
}

}  // namespace

std::vector<std::string> summary_lines(const OffsetStudy& study, std::size_t form_index, const OffsetSummary& summary) {
    std::vector<std::string> lines;
    if (summary.points == 0) return lines;
    const OffsetForm& offset_form = study.tested_forms[form_index];
    const std::string row_text = fmt::format("{} {} {}", offset_form.tested_form.form->info->name,
                                             offset_form.tested_form.format.name, name_of(offset_form.point_kind));
    for (const Side side : measure::offset::both_sides) {
        const measure::offset::SideSummary& side_summary = summary.side_summary(side);
        lines.push_back(fmt::format(
            "{} {}: {}; right for all {}: {}", row_text, name_of(side), safe_offset_text(side_summary),
            text::count_with_noun(side_summary.ray_count, "ray"), faultless_strategies(study, side_summary)));
    }

    const auto strategies_for_both_sides = measure::offset::find_safe_strategies(
        summary, study.strategies, offset_form.tested_form.form->shape, measure::offset::both_sides);
    if (!strategies_for_both_sides.empty())
        lines.push_back(
            fmt::format("{}: the cheapest strategy that is right on both sides is {}, with {}", row_text,
                        strategies_for_both_sides.front().strategy->name,
                        text::count_with_noun(strategies_for_both_sides.front().operation_count, "operation")));
    return lines;
}

}  // namespace lostbits::output::offset
