#include "output/consistency/consistency_files.hpp"

#include <fmt/format.h>

#include <cmath>

#include "output/blame/explain_command.hpp"
#include "output/map/row_names.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::consistency {

using measure::answer::Outcome;
using measure::consistency::Accord;
using measure::consistency::accord_names;
using measure::consistency::AccordOfPixels;
using measure::consistency::Check;
using measure::consistency::CheckSummary;
using measure::consistency::ConsistencyBand;
using measure::consistency::ConsistencyRequest;
using measure::consistency::RowChecks;
using measure::evaluate::TestedForm;
using pixel::colour_of;
using pixel::PixelColumn;
using pixel::PixelValue;
using pixel::share_text;
using table::Table;

namespace {

constexpr const char* excess_unit = "ulps of the length";
/// Category of pixels where numbers are compared and both rays hit.
constexpr std::size_t on_ramp = accord_names.size();

/// Scale of the excess: by how many ulps the two ends of a chord are further apart than the exact ones.
image::ColourScale excess_scale() { return pixel::magnitude_scale(0x1p-2, 0x1p14); }

pixel::Look look_of(const Check& check) {
    return {
        {{"not asked", colour_of(Outcome::agree_miss)},
         {"both answers are alike", colour_of(Outcome::agree_hit)},
         {fmt::format("yes only for: {}", check.first), colour_of(Outcome::false_hit),
          "only the first question is answered with yes"},
         {fmt::format("yes only for: {}", check.second), colour_of(Outcome::false_miss), "only the second question is"},
         {"alike, but other numbers", colour_of(Outcome::not_a_number)},
         {"the inputs differ, not the form", colour_of(Outcome::wrong_object)},
         {"not proved", colour_of(Outcome::unresolved)},
         {""}},
        check.numbers ? std::optional(excess_scale()) : std::nullopt,
        check.numbers ? excess_unit : ""};
}

std::vector<PixelColumn<ConsistencyBand>> columns_of(const ConsistencyRequest& request) {
    std::vector<PixelColumn<ConsistencyBand>> columns;
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        for (std::size_t c = 0; c < request.checks.size(); ++c) {
            const Check& check = *request.checks[c];
            const auto& row = request.rows[r];
            pixel::ColumnSpec spec{.file = fmt::format("{}.{}.png", map::row_name(row), check.name),
                                   .title = fmt::format("{}: {}", check.name, check.title),
                                   .subtitle = {fmt::format("{} in {}", row.form->info->name, row.format.name)},
                                   .look = std::make_shared<const pixel::Look>(look_of(check)),
                                   .places = {{c, r}}};
            if (check.numbers)
                spec.subtitle.emplace_back(
                    "colour: by how much more than the exact answers the chord differs from either end, clamped at "
                    "both ends of the bar");
            columns.push_back(
                {std::move(spec), r, pixel::drawn_by<ConsistencyBand>([c](const ConsistencyBand& band, std::size_t i) {
                     const auto& pixels = band.checks[c];
                     const auto accord = static_cast<std::size_t>(pixels.accord[i]);
                     return pixels.excess.empty() || std::isnan(pixels.excess[i])
                                ? PixelValue{accord}
                                : PixelValue{on_ramp, pixels.excess[i]};
                 })});
        }
    }
    return columns;
}

image::SheetSpec sheet_spec(const ConsistencyRequest& request) {
    image::SheetSpec spec{
        .title = request.scene.title,
        .subtitle =
            {fmt::format("{}, {} x {} pixels: one question put in two ways, and whether a form answers both "
                         "alike",
                         request.scene.id, request.scene.width, request.scene.height),
             "shares are of the pixels of which both are asked; reverse and placed have on the ramp by how much "
             "more than the exact answers both chords, or both t, differ"},
        .forms = {},
        .formats = {},
        .scales = {excess_scale()},
        .unit = excess_unit,
        .legend = {},
        .categories = true};
    for (const Check* check : request.checks) spec.forms.emplace_back(check->name);
    for (const auto& row : request.rows)
        spec.formats.push_back(fmt::format("{} {}", map::short_name(*row.form->info), row.format.name));
    return spec;
}

std::string note_of(const Check& check, const CheckSummary& s) {
    if (s.asked() == 0) return "not asked";
    // An end at the hit may count or not, by convention: an answer of yes everywhere is not a difference.
    if (check.measure == measure::consistency::check_end) {
        const auto yes = s.of(Accord::second_alone);
        return yes == 0 ? "always no" : yes == s.asked() ? "always yes" : share_text(yes, s.asked()) + " yes";
    }
    const char* const alike = s.excess.count() > 0 ? "decisions alike" : "all alike";
    std::string note = s.decisions() == 0 ? alike : share_text(s.decisions(), s.asked()) + " differ";
    if (const auto inputs = s.of(Accord::by_inputs); inputs > 0 && !check.numbers)
        note += fmt::format("\n{} by inputs", share_text(inputs, s.asked()));
    if (s.excess.count() > 0)
        note += fmt::format("\np99 {:.3g}, max {:.3g} ulps", s.excess.quantile(0.99), s.excess.quantile(1));
    else if (s.of(Accord::other_number) > 0)
        note += fmt::format("\n{} other bits", share_text(s.of(Accord::other_number), s.asked()));
    return note;
}

Table<AccordPixel> pixel_table(const ConsistencyRequest& request) {
    using R = AccordPixel;
    std::string known;
    for (const std::string_view name : accord_names) known += fmt::format("{}{}", known.empty() ? "" : ", ", name);
    Table<R> table{
        {"x", "integer", "", "column of the pixel", [](const R& r) { return static_cast<int>(r.i) % r.band->width; }},
        {"y", "integer", "", "row of the pixel",
         [](const R& r) { return r.band->y0 + static_cast<int>(r.i) / r.band->width; }}};
    for (std::size_t c = 0; c < request.checks.size(); ++c) {
        const Check& check = *request.checks[c];
        table.add({std::string(check.name), "string", "", fmt::format("{}: {}", check.title, known),
                   [c](const R& r) { return accord_names[static_cast<std::size_t>(r.band->checks[c].accord[r.i])]; }});
        if (!check.numbers) continue;
        const auto number = [c](std::vector<double> AccordOfPixels::*numbers) {
            return [c, numbers](const R& r) {
                const AccordOfPixels& pixels = r.band->checks[c];
                return pixels.excess.empty() ? file::Cell() : file::number_or_missing((pixels.*numbers)[r.i]);
            };
        };
        table.add({{fmt::format("{}_apart", check.name), "number", "ulp",
                    "|near + far from the other end - length| in ulps of the length; for placed |t - the other t| in "
                    "ulps of t",
                    number(&AccordOfPixels::apart)},
                   {fmt::format("{}_excess", check.name), "number", "ulp",
                    "difference between that and the same for the exact answers", number(&AccordOfPixels::excess)}});
    }
    return table;
}

Table<CheckRow> check_table() {
    using R = CheckRow;
    Table<R> table{{"check", "string", "", "the check: which two questions are compared",
                    [](const R& r) { return r.check->name; }}};
    table.add(table::subject_columns("form that is asked", "format that everything is computed in"), &R::row);
    for (const auto& column : measure::consistency::consistency_columns())
        table.add(table::measured_column<R>(column, [](const auto& c, const R& r) { return c.value(*r.summary); }));
    const auto explain = [](auto ray) {
        return [ray](const R& r) {
            const auto& shown = r.summary->shown;
            return shown && !(shown->rays.*ray).solids.empty()
                       ? blame::explain_command(blame::name_of_ray(&(shown->rays.*ray)), *r.row)
                       : std::string();
        };
    };
    using Rays = decltype(CheckSummary{}.shown->rays);
    return table.add(
        {{"first_x", "integer", "", "column of the first pixel whose difference the form causes",
          [](const R& r) { return r.summary->shown ? file::Cell(r.summary->shown->x) : file::Cell(); }},
         {"first_y", "integer", "", "its row",
          [](const R& r) { return r.summary->shown ? file::Cell(r.summary->shown->y) : file::Cell(); }},
         {"first_explain", "string", "", "command that explains the ray of the first question there",
          explain(&Rays::first)},
         {"second_explain", "string", "", "command that explains the ray of the second", explain(&Rays::second)}});
}

}  // namespace

ConsistencyFiles::ConsistencyFiles(const ConsistencyRequest& request, pixel::SceneFilesOptions options)
    : request_(request),
      options_(std::move(options)),
      table_(options_.folder, "summary.csv", "One row per check, form and format", check_table()),
      pictures_({.scene = request.scene,
                 .sheets = {{options_.sheet(), sheet_spec(request)}},
                 .singles = options_.folder_of_singles(),
                 .stop = request.limit.stop},
                columns_of(request)) {
    if (!options_.pixels_csv) return;
    for (const TestedForm& row : request.rows)
        pixels_.push_back(std::make_unique<table::TableFile<AccordPixel>>(options_.folder, map::row_name(row) + ".csv",
                                                                          "One row per pixel", pixel_table(request)));
}

void ConsistencyFiles::band(std::size_t row, const ConsistencyBand& band) {
    pictures_.take(row, band, band.y0, band.checks.front().accord.size());
    if (pixels_.empty()) return;
    for (std::size_t i = 0; i < band.checks.front().accord.size(); ++i) pixels_[row]->add({&band, i});
}

void ConsistencyFiles::finish(const std::vector<RowChecks>& rows) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t c = 0; c < rows[r].size(); ++c) {
            pictures_.writer().set_note({c, r}, note_of(*request_.checks[c], rows[r][c]));
            table_.add({request_.checks[c], &request_.rows[r], &rows[r][c]});
        }
    }
    pictures_.writer().finish();
    if (!options_.folder.empty()) table::close_tables(options_.folder, request_.scene.title, table_, pixels_);
}

}  // namespace lostbits::output::consistency
