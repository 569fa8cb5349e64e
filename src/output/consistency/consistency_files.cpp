#include "output/consistency/consistency_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/attribution/explain_command.hpp"
#include "output/file/number_text.hpp"
#include "output/map/form_names.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::consistency {

using measure::answer::Outcome;
using measure::consistency::Check;
using measure::consistency::check_result_names;
using measure::consistency::CheckResult;
using measure::consistency::CheckSummary;
using measure::consistency::ConsistencyBand;
using measure::consistency::ConsistencyStudy;
using measure::consistency::PixelCheckResults;
using pixel::colour_of;
using pixel::DrawnColumn;
using pixel::fraction_text;
using pixel::PixelValue;
using table::Table;

namespace {

constexpr const char* excess_unit = "ulps of the length";
/// Category of pixels drawn with the colour scale: both rays hit, and the numbers are compared.
constexpr std::size_t ramp_category = check_result_names.size();

/// Scale of the excess: the number of ulps by which the two ends of a chord are further apart than the exact ends.
image::ColourScale excess_scale() { return pixel::magnitude_scale(0x1p-2, 0x1p14); }

pixel::Look check_look(const Check& check) {
    return {{{"not asked", colour_of(Outcome::agree_miss)},
             {"both answers are alike", colour_of(Outcome::agree_hit)},
             {fmt::format("yes only for: {}", check.first_question), colour_of(Outcome::false_hit),
              "only the first question is answered with yes"},
             {fmt::format("yes only for: {}", check.second_question), colour_of(Outcome::false_miss),
              "only the second question is answered with yes"},
             {"alike, but other numbers", colour_of(Outcome::not_a_number)},
             {"the inputs differ, not the form", colour_of(Outcome::wrong_primitive)},
             {"not proved", colour_of(Outcome::unresolved)},
             {""}},
            check.compares_numbers ? std::optional(excess_scale()) : std::nullopt,
            check.compares_numbers ? excess_unit : ""};
}

/// Note below a cell of the sheet: how often the two answers differ, and by how much.
std::string summary_note(const Check& check, const CheckSummary& s) {
    if (s.question_count() == 0) return "not asked";
    // An end at the hit may count or not, by convention: an answer of yes everywhere is not a difference.
    if (check.measure == measure::consistency::check_end) {
        const auto yes_count = s.count_of(CheckResult::second_alone);
        return yes_count == 0                    ? "always no"
               : yes_count == s.question_count() ? "always yes"
                                                 : fraction_text(yes_count, s.question_count()) + " yes";
    }

    const char* const agreement = s.excess.count() > 0 ? "decisions alike" : "all alike";
    std::string note = s.decisions() == 0 ? agreement : fraction_text(s.decisions(), s.question_count()) + " differ";
    if (const auto input_count = s.count_of(CheckResult::by_inputs); input_count > 0 && !check.compares_numbers)
        note += fmt::format("\n{} by inputs", fraction_text(input_count, s.question_count()));

    if (s.excess.count() > 0)
        note += fmt::format("\np99 {}, max {} ulps", file::short_decimal(s.excess.quantile(0.99), 3),
                            file::short_decimal(s.excess.quantile(1), 3));
    else if (s.count_of(CheckResult::other_number) > 0)
        note +=
            fmt::format("\n{} other bits", fraction_text(s.count_of(CheckResult::other_number), s.question_count()));
    return note;
}

}  // namespace

std::string ConsistencyPresentation::file_stem(const ConsistencyStudy& study, std::size_t form_index) {
    return map::tested_form_name(study.tested_forms[form_index]);
}

std::vector<DrawnColumn<ConsistencyBand>> ConsistencyPresentation::columns(const ConsistencyStudy& study) {
    std::vector<DrawnColumn<ConsistencyBand>> columns;
    for (std::size_t r = 0; r < study.tested_forms.size(); ++r) {
        for (std::size_t c = 0; c < study.checks.size(); ++c) {
            const Check& check = *study.checks[c];
            const auto& tested_form = study.tested_forms[r];
            pixel::ColumnSpec spec{
                .file = fmt::format("{}.{}.png", file_stem(study, r), check.name),
                .title = fmt::format("{}: {}", check.name, check.title),
                .subtitle = {fmt::format("{} in {}", tested_form.form->info->name, tested_form.format.name)},
                .look = std::make_shared<const pixel::Look>(check_look(check)),
                .sheet_positions = {{c, r}}};
            if (check.compares_numbers)
                spec.subtitle.emplace_back(
                    "colour: by how much more than the exact answers the chord differs from either end, clamped at "
                    "both ends of the bar");

            // A pixel shows the number if there is one, and otherwise the result of the check.
            const auto value = [c](const ConsistencyBand& band, std::size_t i) {
                const auto& pixels = band.checks[c];
                const auto result = static_cast<std::size_t>(pixels.results[i]);
                return pixels.excess.empty() || std::isnan(pixels.excess[i])
                           ? PixelValue{result}
                           : PixelValue{ramp_category, pixels.excess[i]};
            };
            columns.push_back({std::move(spec), r, pixel::make_draw_function<ConsistencyBand>(value)});
        }
    }
    return columns;
}

pixel::SheetFile ConsistencyPresentation::sheet(const ConsistencyStudy& study, const std::filesystem::path& file) {
    image::SheetSpec spec{
        .title = study.scene.title,
        .subtitle = {fmt::format(
                         "{}, {} x {} pixels: one question asked in two ways, and whether a form gives the same "
                         "answer to both",
                         study.scene.id, study.scene.width, study.scene.height),
                     "shares are of the pixels of which both are asked"},
        .shows_categories = true};
    if (std::ranges::any_of(study.checks, &Check::compares_numbers)) {
        spec.subtitle.back() +=
            "; reverse and placed have on the ramp by how much more than the exact answers both chords, or both t, "
            "differ";
        spec.scales = {excess_scale()};
        spec.bar_label = excess_unit;
    }

    for (const Check* check : study.checks) spec.column_labels.emplace_back(check->name);
    for (const auto& tested_form : study.tested_forms)
        spec.row_labels.push_back(
            fmt::format("{} {}", map::short_name(*tested_form.form->info), tested_form.format.name));
    return {file, std::move(spec)};
}

std::vector<study::Note> ConsistencyPresentation::notes(const ConsistencyStudy& study,
                                                        const std::vector<FormChecks>& rows) {
    std::vector<study::Note> notes;
    for (std::size_t r = 0; r < rows.size(); ++r)
        for (std::size_t c = 0; c < rows[r].size(); ++c)
            notes.push_back({{c, r}, summary_note(*study.checks[c], rows[r][c])});
    return notes;
}

Table<study::PixelInBand<ConsistencyBand>> ConsistencyPresentation::make_pixel_table(const ConsistencyStudy& study) {
    using R = study::PixelInBand<ConsistencyBand>;
    std::string result_names;
    for (const std::string_view name : check_result_names)
        result_names += fmt::format("{}{}", result_names.empty() ? "" : ", ", name);

    Table<R> table = study::position_columns<ConsistencyBand>();
    for (std::size_t c = 0; c < study.checks.size(); ++c) {
        const Check& check = *study.checks[c];
        table.add({std::string(check.name), fmt::format("{}: {}", check.title, result_names), [c](const R& r) {
                       return check_result_names[static_cast<std::size_t>(r.band->checks[c].results[r.i])];
                   }});
        if (!check.compares_numbers) continue;

        // The difference of the two answers in numbers.
        const auto number = [c](std::vector<double> PixelCheckResults::*numbers) {
            return [c, numbers](const R& r) {
                const PixelCheckResults& pixels = r.band->checks[c];
                return file::number_or_missing(pixels.excess.empty() ? measure::truth::missing
                                                                     : (pixels.*numbers)[r.i]);
            };
        };
        table.add({{fmt::format("{}_apart", check.name), "ulp",
                    "|near + far from the other end - length| in ulps of the length; for placed |t - the other t| in "
                    "ulps of t",
                    number(&PixelCheckResults::apart)},
                   {fmt::format("{}_excess", check.name), "ulp", "the same minus its value for the exact answers",
                    number(&PixelCheckResults::excess)}});
    }
    return table;
}

namespace {

/// Columns of the numbers of a check.
Table<CheckSummary> number_columns() {
    using S = CheckSummary;
    using table::fraction_or_missing, table::percentile;
    const auto count = [](CheckResult result) { return [result](const S& s) { return s.count_of(result); }; };
    return {
        {"rays", "pixels at which both questions are asked", &S::question_count},
        {"agree", "of these, pixels with the same answer to both questions", count(CheckResult::agree)},
        {"first_alone", "the answer is yes only to the first question, and one of the answers is wrong",
         count(CheckResult::first_alone)},
        {"second_alone", "the answer is yes only to the second, and one of the answers is wrong",
         count(CheckResult::second_alone)},
        {"other_number",
         "the decisions are the same, the numbers are not: they differ in any bit (packs), or by an ulp more than the "
         "exact ones (reverse, placed)",
         count(CheckResult::other_number)},
        {"by_inputs", "the answers differ as the exact ones do: the stored numbers of the questions differ",
         count(CheckResult::by_inputs)},
        {"unresolved", "the answers differ, and the exact ones are not proved", count(CheckResult::unresolved)},

        // Fractions, and how far numbers are apart
        {"disagree_fraction", "share of first_alone, second_alone and other_number",
         [](const S& s) { return fraction_or_missing(s.disagreements(), s.question_count()); }},
        {"decision_fraction", "share of first_alone and second_alone",
         [](const S& s) { return fraction_or_missing(s.decisions(), s.question_count()); }},
        {"by_inputs_fraction", "share of by_inputs",
         [](const S& s) { return fraction_or_missing(s.count_of(CheckResult::by_inputs), s.question_count()); }},
        {"apart_p50", "ulp",
         "|near + far from the other end - length| in ulps of the length; for placed |t - the other t| in ulps of t, "
         "as computed: median",
         percentile(&S::apart, 50)},
        {"apart_p99", "ulp", "the same: 99th percentile", percentile(&S::apart, 99)},
        {"apart_max", "ulp", "the same: largest", percentile(&S::apart, 100)},
        {"excess_p50", "ulp", "the same minus its value for the exact answers: median", percentile(&S::excess, 50)},
        {"excess_p99", "ulp", "the same: 99th percentile", percentile(&S::excess, 99)},
        {"excess_max", "ulp", "the same: largest", percentile(&S::excess, 100)}};
}

}  // namespace

Table<CheckRow> ConsistencyPresentation::make_summary_table() {
    using R = CheckRow;
    Table<R> table{{"check", "the check: which two questions are compared", [](const R& r) { return r.check->name; }}};
    table.add(table::make_subject_columns("form that is asked", "format that everything is computed in"), &R::row);
    table.add(number_columns(), &R::summary);

    // The first pixel where the form contradicts itself, and the commands that explain its two rays.
    const auto explain = [](auto ray) {
        return [ray](const R& r) {
            const auto& shown_pixel = r.summary->first_disagreement;
            return shown_pixel && !(shown_pixel->rays.*ray).primitives.empty()
                       ? attribution::explain_command(attribution::explain_ray_arguments(&(shown_pixel->rays.*ray)),
                                                      *r.row)
                       : std::string();
        };
    };
    const auto shown_at = [](auto part) {
        return [part](const R& r) {
            return r.summary->first_disagreement ? std::optional(part(*r.summary->first_disagreement)) : std::nullopt;
        };
    };
    using Rays = decltype(CheckSummary{}.first_disagreement->rays);
    return table.add(
        {{"first_x", "column of the first pixel whose difference the form causes",
          shown_at([](const auto& shown) { return shown.x; })},
         {"first_y", "its row", shown_at([](const auto& shown) { return shown.y; })},
         {"first_explain", "command that explains the ray of the first question there", explain(&Rays::first)},
         {"second_explain", "command that explains the ray of the second", explain(&Rays::second)}});
}

std::vector<CheckRow> ConsistencyPresentation::make_summary_rows(const ConsistencyStudy& study,
                                                                 const std::vector<FormChecks>& rows) {
    std::vector<CheckRow> check_rows;
    for (std::size_t r = 0; r < rows.size(); ++r)
        for (std::size_t c = 0; c < rows[r].size(); ++c)
            check_rows.push_back({study.checks[c], &study.tested_forms[r], &rows[r][c]});
    return check_rows;
}

}  // namespace lostbits::output::consistency
