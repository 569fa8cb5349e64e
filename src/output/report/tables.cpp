// Tables of maps, a choice, a repaired form, offsets and other studies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measure/evaluate/summary_columns.hpp"
#include "output/file/number_text.hpp"
#include "output/map/form_names.hpp"
#include "output/offset/offset_files.hpp"
#include "output/repair/repair_files.hpp"
#include "output/report/page.hpp"
#include "output/report/text.hpp"

namespace lostbits::output::report {

using measure::offset::both_sides;
using measure::offset::Side;

namespace {

/// `30.3 %`. A fraction of nothing is a dash, and an exact 0 is written as `0`.
std::string fraction_cell(double fraction) {
    if (std::isnan(fraction)) return "<td class=\"n\">&ndash;</td>";
    const std::string text = fraction == 0      ? "0"
                             : fraction < 0.001 ? "&lt; 0.1 %"
                                                : fmt::format("{:.3g} %", 100 * fraction);
    return fmt::format("<td class=\"n\"><data value=\"{}\">{}</data></td>", file::decimal(fraction), text);
}

/// A column of a table of the page, which shows a column of a CSV file under another title.
struct ShownColumn {
    const char *title, *column;
};

/// Columns of the table of strategies. Those that are not fractions are factors.
constexpr ShownColumn strategy_columns[] = {{"rays wrong", "bad_fraction"},
                                            {"self-hits", "self_hit_fraction"},
                                            {"self-hits by the form", "self_hit_by_form_fraction"},
                                            {"lost occluders", "lost_occluder_fraction"},
                                            {"lost exits", "lost_exit_fraction"},
                                            {"wrong side", "wrong_side_fraction"},
                                            {"times larger, p50", "oversize_p50"},
                                            {"p99", "oversize_p99"}};

/// Columns of the wrong outcomes. Those of meshes are only for scenes with a mesh.
std::vector<ShownColumn> count_columns_for(const scene::file::Scene& scene) {
    std::vector<ShownColumn> count_columns{{"false hits", "false_hit"},
                                           {"false misses", "false_miss"},
                                           {"NaN", "not_a_number"},
                                           {"wrong primitives", "wrong_primitive"}};
    if (scene.mesh)
        count_columns.insert(count_columns.end(),
                             {{"cracks", "crack"}, {"double hits", "double_hit"}, {"out of order", "out_of_order"}});
    count_columns.push_back({"unresolved", "unresolved"});
    return count_columns;
}

std::string summary_table_head(const std::vector<ShownColumn>& count_columns) {
    std::vector<std::string> names{"form", "format"};
    for (const ShownColumn& count_column : count_columns) names.emplace_back(count_column.title);
    names.insert(names.end(), {"agreed hits", "lost bits p50", "p99", "max", "excess p99", "worst pixel"});
    return begin_table(names);
}

/// Cell with a link to the pixel of the worst ray; a dash if every ray is a correct miss.
std::string worst_pixel_cell(const scene::file::Scene& scene, const TestedForm& tested_form,
                             const FormSummary& summary) {
    const measure::evaluate::WorstRay* const worst = summary.worst_ray();
    if (worst == nullptr) return "<td>&ndash;</td>";
    return fmt::format(
        "<td><a class=\"jump\" href=\"#scene-{}\" "
        "data-view=\"scene={}&amp;form={}&amp;format={}&amp;x={}&amp;y={}\">{}, {}</a></td>",
        html(scene.id), html(scene.id), html(tested_form.form->info->name), tested_form.format.name, worst->x, worst->y,
        worst->x, worst->y);
}

/// Row of a form and format in the table of a map. `value(name)` is the value of the column `name` of summary.csv.
std::string summary_table_row(const scene::file::Scene& scene, const TestedForm& tested_form,
                              const FormSummary& summary, const std::vector<ShownColumn>& count_columns,
                              const auto& value) {
    std::string text = fmt::format("<tr data-row=\"{}\"><th scope=\"row\">{}</th><td>{}</td>",
                                   html(map::tested_form_name(tested_form)), html(tested_form.form->info->name),
                                   tested_form.format.name);

    // Numbers of rays with each outcome.
    for (const ShownColumn& count_column : count_columns)
        text += fmt::format("<td class=\"n\">{}</td>", static_cast<std::uint64_t>(value(count_column.column)));
    text += fmt::format("<td class=\"n\">{}</td>", summary.count(measure::answer::Outcome::agree_hit));

    // Quantiles are withheld if too few hits agree.
    if (summary.true_hit_count > 0 && !summary.agreement().is_enough()) {
        text += fmt::format("<td class=\"few\" colspan=\"4\">{}</td>", summary.agreement().too_few_text());
    } else {
        for (const char* name : {"lost_bits_p50", "lost_bits_p99", "lost_bits_max", "excess_bits_p99"})
            text += fmt::format("<td class=\"n\">{}</td>", number_html(value(name)));
    }
    return text + worst_pixel_cell(scene, tested_form, summary) + "</tr>\n";
}

}  // namespace

std::string summary_table(const MapStudy& study, const std::vector<FormSummary>& summaries) {
    const auto columns = measure::evaluate::make_summary_columns(study.metrics);
    const std::vector<ShownColumn> count_columns = count_columns_for(*study.scene);
    std::string text = summary_table_head(count_columns);
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        const auto value = [&](std::string_view name) {
            return measure::evaluate::find_column(columns, name)->value(summaries[r]);
        };
        text += summary_table_row(*study.scene, study.tested_forms[r], summaries[r], count_columns, value);
    }
    return text + end_table;
}

std::string choice_table(const choose::ChoiceResult& chosen) {
    std::string text = begin_table({"form", "format", "registers", "ns per ray and primitive", "bits kept",
                                    "rays wrong", "meets the requirement"});
    for (const std::size_t k : measure::choose::order_by_price(chosen.candidates)) {
        const measure::choose::Candidate& candidate = chosen.candidates[k];
        text += fmt::format("<tr{}><th scope=\"row\">{}</th><td>{}</td><td>{}</td>",
                            chosen.cheapest_index == k ? " class=\"chosen\"" : "",
                            html(candidate.tested_form.form->info->name), candidate.tested_form.format.name,
                            candidate.isa == "scalar" ? "one ray" : fmt::format("{} bits", candidate.isa));
        text += fmt::format(
            "<td class=\"n\">{:.2f}</td><td class=\"n\">{}</td>", candidate.time.median * 1e9,
            std::isnan(candidate.quality.kept_bits) ? "&ndash;" : file::kept_bits_text(candidate.quality.kept_bits));
        text += fraction_cell(candidate.quality.wrong_fraction());
        text += fmt::format("<td>{}</td></tr>\n", chosen.cheapest_index == k                            ? "yes, chosen"
                                                  : candidate.quality.meets(chosen.request.requirement) ? "yes"
                                                                                                        : "no");
    }
    return text + end_table;
}

std::string mend_table(const repair::RepairSummary& result) {
    const auto& requirement = result.request.requirement;
    const auto proposals = list_proposals(result);
    const repair::Proposal* const best = best_proposal(proposals, result);

    // The head. Without times, it has no columns of times.
    std::vector<std::string> names{
        "form",       "rounding operations",  "of them in " + repair::wider_format_name(result.repair.wider),
        "bits kept",  "rays wrong",           "on other rays: bits kept",
        "rays wrong", "meets the requirement"};
    if (!result.prices.empty()) names.insert(names.end(), {"ns per ray and primitive in packs", "ns alone", "front"});
    std::string text = begin_table(names);

    const auto add_cell = [&text](double value) { text += fmt::format("<td class=\"n\">{}</td>", number_html(value)); };
    for (const repair::FormRow& row : make_form_rows(result)) {
        if (!row.is_shown) continue;
        const bool is_best = best && best->quality == row.quality;
        const bool is_known = row.rounding_operation_count > 0;

        // The form, its operations, and its accuracy on the rays of the search and on others.
        text += fmt::format("<tr{}><th scope=\"row\">{}</th>", is_best ? " class=\"chosen\"" : "", html(row.name));
        add_cell(is_known ? static_cast<double>(row.rounding_operation_count) : NAN);
        add_cell(is_known ? static_cast<double>(row.wider_operations) : NAN);
        for (const auto* const quality : {row.quality, row.held_out_quality}) {
            add_cell(quality ? quality->kept_bits : NAN);
            add_cell(quality ? static_cast<double>(quality->wrong_count) : NAN);
        }

        // The verdict, and the times.
        text += fmt::format("<td>{}</td>", is_best                           ? "yes, recommended"
                                           : row.quality->meets(requirement) ? "yes"
                                                                             : "no");
        if (!result.prices.empty()) {
            add_cell(row.price ? row.price->packed.median * 1e9 : NAN);
            add_cell(row.price ? row.price->single.median * 1e9 : NAN);
            text += fmt::format("<td>{}</td>", row.is_on_pareto_front ? "yes" : row.price ? "no" : "");
        }
        text += "</tr>\n";
    }
    return text + end_table;
}

std::string offset_table(const measure::offset::OffsetStudy& study,
                         const std::vector<measure::offset::OffsetSummary>& summaries) {
    auto table = offset::OffsetPresentation::make_summary_table();
    const auto rows = offset::OffsetPresentation::make_summary_rows(study, summaries);
    std::string text = "<div class=\"pair\">\n";
    for (const Side side : both_sides) {
        std::vector<std::string> names{"strategy"};
        for (const ShownColumn& column : strategy_columns) names.emplace_back(column.title);
        text += begin_table(names, "", fmt::format("Rays {}", offset::side_phrase(side)));

        for (const offset::StrategyRow& row : rows) {
            if (row.side != side) continue;
            text += fmt::format("<tr><th scope=\"row\">{}</th>", html(offset::short_name(*row.strategy)));
            for (const ShownColumn& column : strategy_columns) {
                const double value = table.find(column.column)->value(row).number();
                text += std::string_view(column.column).ends_with("_fraction")
                            ? fraction_cell(value)
                            : fmt::format("<td class=\"n\">{}</td>", number_html(value));
            }
            text += "</tr>\n";
        }
        text += end_table;
    }
    return text + "</div>\n";
}

std::string study_table(const std::vector<file::Column>& columns, const std::vector<std::vector<file::Cell>>& rows) {
    // Leave out columns that are empty in every row, and columns of commands.
    const auto is_used = [](const file::Cell& cell) { return !cell.is_missing() && !cell.text().empty(); };
    const auto is_command = [](const file::Cell& cell) { return cell.text().starts_with("lostbits "); };
    std::vector<std::size_t> shown_columns;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const auto any_row = [&](const auto& predicate) {
            return std::ranges::any_of(rows, [&](const auto& r) { return predicate(r[c]); });
        };
        if (any_row(is_used) && !any_row(is_command)) shown_columns.push_back(c);
    }

    std::vector<std::string> names;
    for (const std::size_t c : shown_columns)
        names.push_back(columns[c].name + (columns[c].unit.empty() ? "" : " [" + columns[c].unit + "]"));
    std::string text = begin_table(names);

    for (const auto& row : rows) {
        text += "<tr>";
        for (const std::size_t c : shown_columns)
            text += columns[c].type == "string" ? fmt::format("<td>{}</td>", html(row[c].text()))
                                                : fmt::format("<td class=\"n\">{}</td>", number_html(row[c].number()));
        text += "</tr>\n";
    }
    return text + end_table;
}

std::string offset_overview(const std::vector<StudySection>& parts) {
    const auto strategies = measure::offset::all_strategies();
    std::string text = "<div class=\"pair\">\n";
    for (const Side side : both_sides) {
        std::vector<std::string> names{"strategy"};
        for (const StudySection& section : parts) names.push_back(section.id);
        text += begin_table(names, "", fmt::format("Rays {}", offset::side_phrase(side)));

        for (std::size_t k = 0; k < strategies.size(); ++k) {
            text += fmt::format("<tr><th scope=\"row\">{}</th>", html(offset::short_name(*strategies[k])));
            for (const StudySection& section : parts)
                text += fraction_cell(section.wrong_fractions[static_cast<std::size_t>(side)][k]);
            text += "</tr>\n";
        }
        text += end_table;
    }
    return text + "</div>\n";
}

}  // namespace lostbits::output::report
