#include "output/report/page.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "measure/check/claim_columns.hpp"
#include "output/file/number_text.hpp"
#include "output/report/assets.hpp"
#include "output/report/sweep_data.hpp"
#include "output/report/text.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::report {

using measure::check::ClaimResult;

namespace {

using scene::check::Claim;
using scene::check::SceneSubject;
using scene::check::SweepSubject;
using State = ClaimResult::State;

template <class MapOrSweep>
bool has_row(const MapOrSweep& section, const Claim& claim) {
    return std::ranges::find(section.tested_form_names, fmt::format("{}.{}", claim.form, claim.format)) !=
           section.tested_form_names.end();
}

/// Position of a claim's subject on the page: the anchor of an element for readers without scripts, and the view that
/// scripts show.
struct PagePosition {
    std::string anchor, view;
    bool is_drawn = true;  ///< the view shows the quantity that the claim is about
};

std::optional<PagePosition> find_position_in(const SceneSubject& subject, const Claim& claim, const ClaimResult& result,
                                             const Report& report) {
    const auto section = std::ranges::find(report.maps, subject.name, &MapSection::id);
    if (section == report.maps.end() || !has_row(*section, claim)) return {};
    std::string view = fmt::format("scene={}&form={}&format={}", subject.name, claim.form, claim.format);
    const measure::metric::Metric* const metric = check::metric_of_column(claim.metric);
    const bool is_drawn = metric == nullptr
                              ? !measure::check::asks_for_attribution(claim)
                              : std::ranges::find(section->metrics, metric->name) != section->metrics.end();
    if (metric != nullptr && is_drawn) view += fmt::format("&metric={}", metric->name);
    if (section->has_scene_size && subject.pixel)
        view += fmt::format("&x={}&y={}", subject.pixel->first, subject.pixel->second);
    else if (section->has_scene_size && subject.step)
        view += "&x=0&y=0";  // such a claim follows the march of that pixel
    else if (section->has_scene_size && result.witness.x >= 0)
        view += fmt::format("&x={}&y={}", result.witness.x, result.witness.y);
    return PagePosition{"scene-" + subject.name, view, is_drawn};
}

/// Part `&u=…&v=…` of a view that selects the cell that a claim names. Cells are counted in the order of rising values,
/// or in the order of the cases. Empty if the claim names no cell, or a value between two cells. Steps of a power of
/// two are rounded to 12 bits and claims are not, so |step − value| ≤ 2^-12 |value| counts as the same step.
std::string cell_query(const Claim& claim, const SweepSubject& subject, const SweepSection& section) {
    // The first case whose name matches.
    if (const auto* const case_subject = subject.part_if<SweepSubject::Case>();
        case_subject && section.kind == SweepSection::Kind::cases) {
        const auto matches = [case_subject](const std::string& name) {
            return fnmatch(case_subject->name.c_str(), name.c_str(), 0) == 0;
        };
        const auto matching_case = std::ranges::find_if(section.cases, matches);
        return matching_case == section.cases.end()
                   ? ""
                   : fmt::format("&judged={}&v={}", intersect::convention_name(claim.convention),
                                 matching_case - section.cases.begin());
    }

    // The step on each axis.
    std::string text;
    const auto* const point = subject.part_if<SweepSubject::SweepPosition>();
    for (std::size_t a = 0; point && a < point->values.size(); ++a) {
        if (a >= section.axes.size()) return "";
        auto values = section.axes[a];
        std::ranges::sort(values);
        const auto step = std::ranges::find_if(
            values, [x = point->values[a]](double value) { return std::fabs(value - x) <= 0x1p-12 * std::fabs(x); });
        if (step == values.end()) return "";
        text += fmt::format("&{}={}", a == 0 ? "u" : "v", step - values.begin());
    }
    return text;
}

std::optional<PagePosition> find_position_in(const SweepSubject& subject, const Claim& claim, const Report& report) {
    const std::string id = std::filesystem::path(subject.name).stem().string();
    const auto section = std::ranges::find(report.sweeps, id, &SweepSection::id);
    if (section == report.sweeps.end() || !has_row(*section, claim)) return {};
    std::string view = fmt::format("sweep={}&form={}&format={}", id, claim.form, claim.format);
    const std::string column = claim.onset == "lost_bits" ? "lost_bits_" + claim.statistic
                               : claim.onset.empty()      ? claim.metric
                                                          : claim.onset + "_fraction";
    if (std::ranges::find(sweep_statistics, column) != sweep_statistics.end()) view += "&statistic=" + column;
    return PagePosition{"sweep-" + id, view + cell_query(claim, subject, *section)};
}

std::optional<PagePosition> find_position(const Claim& claim, const ClaimResult& result, const Report& report) {
    if (const auto* const scene = claim.subject_if<SceneSubject>())
        return find_position_in(*scene, claim, result, report);
    if (const auto* const sweep = claim.subject_if<SweepSubject>()) return find_position_in(*sweep, claim, report);
    return {};
}

/// Cell with the subject of a claim: a link to its position on the page, or the command that shows it.
std::string subject_cell(const Claim& claim, const ClaimResult& result, const Report& report) {
    const check::SubjectTexts texts = check::subject_texts(claim);
    const std::string text = html(texts.subject),
                      row = fmt::format("<br><small>{} {}</small>", html(claim.tested_name()), html(claim.format));
    const auto position = find_position(claim, result, report);
    if (!position)
        return fmt::format("{}{}<br><small>not on this page: <code>{}</code></small>", text, row, html(texts.command));
    const std::string link =
        fmt::format("<a class=\"jump\" href=\"#{}\"{}>{}</a>", html(position->anchor),
                    position->view.empty() ? "" : fmt::format(" data-view=\"{}\"", html(position->view)), text);
    return position->is_drawn ? link + row
                              : fmt::format("{}{}<br><small>to draw its picture: <code>{}</code></small>", link, row,
                                            html(texts.command));
}

struct VerdictLabel {
    std::string text;
    std::string_view style;
};
VerdictLabel verdict_label(const Claim& claim, const ClaimResult& result) {
    switch (result.state) {
        case State::agrees: return {std::string(name_of(claim.verdict)), name_of(claim.verdict)};
        case State::disagrees: return {check::disagreement_text(claim, result), "differs"};
        case State::unmeasurable: return {"could not be measured", "differs"};
        case State::skipped: break;
    }
    return {"skipped", "skipped"};
}

/// Lets a long line break after each underscore: adds `<wbr>`.
std::string with_line_breaks(std::string text) {
    for (std::size_t position = 0; (position = text.find('_', position)) != std::string::npos; position += 6)
        text.insert(position + 1, "<wbr>");
    return text;
}

/// Cell with the measured number, and its range over the draws.
std::string measured_cell(const ClaimResult& result) {
    if (result.state != State::agrees && result.state != State::disagrees) return html(result.reason);
    if (!result.is_random()) return number_html(result.measured);
    const auto spread = result.spread();
    const std::string draws =
        result.further_measured.empty() ? ""
        : spread.low == spread.high
            ? fmt::format("in each of {} draws ", spread.draws)
            : fmt::format("{} to {} over {} draws ", number_html(spread.low), number_html(spread.high), spread.draws);
    return fmt::format("{}<br><small>{}of {} random samples</small>", number_html(result.measured), draws,
                       result.sample_count);
}

std::string tile(std::size_t n, const char* text, const char* style) {
    return fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", style, n, text);
}

}  // namespace

std::string verdict_tiles(const check::VerdictCounts& counts) {
    std::string text = "<ul class=\"tiles\" id=\"verdicts\">";
    if (counts.differing) text += tile(counts.differing, "failed", "differs");
    if (counts.broken) text += tile(counts.broken, "could not be measured", "differs");
    text += tile(counts.held, "hold", "holds");
    if (counts.qualified) text += tile(counts.qualified, "qualified", "qualified");
    text += tile(counts.refuted, "refuted", "refuted");
    if (counts.skipped) text += tile(counts.skipped, "skipped on this machine", "skipped");
    return text + "</ul>\n";
}

namespace {

/// Attributes by which the browser sorts the rows: the gravity of the verdict, 0 for the gravest, and the measured
/// number.
std::string sort_attributes(const VerdictLabel& label, const ClaimResult& result) {
    static constexpr std::array<std::string_view, 5> gravest{"differs", "refuted", "qualified", "holds", "skipped"};
    const auto gravity = std::ranges::find(gravest, label.style) - gravest.begin();
    const bool is_measured = result.state == State::agrees || result.state == State::disagrees;
    return fmt::format("data-grave=\"{}\" data-measured=\"{}\"", gravity,
                       is_measured ? file::decimal(result.measured) : "");
}

/// `holds: a sample was measured`: the verdict and its evidence. Empty if no evidence is recorded.
std::string evidence_cell(const Claim& claim, const ClaimResult& result, const VerdictLabel& label) {
    const std::string text =
        check::floats_text(result) + (result.state == State::agrees ? check::evidence_text(claim, result) : "");
    return text.empty() ? "" : fmt::format("<br><small class=\"evidence\">{}: {}</small>", label.text, html(text));
}

/// `Shirley, section 9.3: <q>ignore hits</q> &middot; `: the source and its quotation. Empty if the claim is our own.
std::string source_text(const Claim& claim) {
    if (!claim.is_sourced()) return "";
    const std::string quoted = claim.quotation.empty() ? "" : fmt::format(": <q>{}</q>", prose_html(claim.quotation));
    return html(claim.source) + quoted + " &middot; ";
}

std::string claim_row(const Claim& claim, const ClaimResult& result, const Report& report) {
    const VerdictLabel label = verdict_label(claim, result);
    std::string text =
        fmt::format("<tr id=\"claim-{}\" class=\"{}\" {} data-command=\"{}\"><td class=\"verdict\">{}</td><td>{}",
                    html(claim.id), label.style, sort_attributes(label, result),
                    html(check::subject_texts(claim).command), label.text, prose_html(claim.statement));
    if (!claim.note.empty()) text += fmt::format("<br><em>{}</em>", prose_html(claim.note));
    text += evidence_cell(claim, result, label);
    text += fmt::format("<br><small>{}<code>{}</code></small></td>", source_text(claim), html(claim.id));
    return text +
           fmt::format(
               "<td>{}</td><td data-name=\"quantity\">{}</td><td class=\"n\" data-name=\"measured\">{}</td><td "
               "class=\"n\" data-name=\"expected\">{} to {}</td></tr>\n",
               subject_cell(claim, result, report), with_line_breaks(html(check::quantity_text(claim))),
               measured_cell(result), number_html(claim.low),
               number_html(claim.high) +
                   (claim.draws == 0 ? "" : fmt::format("<br><small>from {} draws</small>", claim.draws)) +
                   (claim.criterion ? fmt::format("<br><small>{}</small>", html(check::criterion_text(claim))) : ""));
}

/// `12 claims: 1 failed, 9 hold, 2 refuted`
std::string counts_text(std::size_t claim_count, const check::VerdictCounts& counts) {
    std::string text;
    const auto add = [&text](std::size_t count, const char* label, const char* style) {
        if (count == 0) return;
        text += fmt::format("{}<span class=\"{}\">{} {}</span>", text.empty() ? "" : ", ", style, count, label);
    };
    add(counts.differing, "failed", "differs");
    add(counts.broken, "could not be measured", "differs");
    add(counts.held, counts.held == 1 ? "holds" : "hold", "holds");
    add(counts.qualified, "qualified", "qualified");
    add(counts.refuted, "refuted", "refuted");
    add(counts.skipped, "skipped", "skipped");
    return fmt::format("{}: {}", text::count_with_noun(claim_count, "claim"), text);
}

/// Title under which the page shows a subject; empty if the page does not show it.
std::string find_title(const std::string& subject, const Report& report) {
    const auto map = std::ranges::find(report.maps, subject, &MapSection::id);
    if (map != report.maps.end()) return map->title;
    const auto sweep =
        std::ranges::find(report.sweeps, std::filesystem::path(subject).stem().string(), &SweepSection::id);
    return sweep == report.sweeps.end() ? "" : sweep->title;
}

}  // namespace

std::string claims_table(const Report& report) {
    std::string text;
    for (const check::ClaimSubject& subject : check::group_by_subject(report.claims)) {
        // The rows of the claims, and the counts of their verdicts.
        check::VerdictCounts counts;
        std::string rows;
        for (const std::size_t i : subject.claims) {
            counts.add(report.claims[i], report.results[i]);
            rows += claim_row(report.claims[i], report.results[i], report);
        }

        const std::string title = find_title(subject.name, report);
        text += fmt::format(
            "<details open class=\"part subject\"><summary>{}<code>{}</code> <small>{}</small></summary>\n{}{}{}"
            "</details>\n",
            title.empty() ? "" : html(title) + " ", html(subject.name), counts_text(subject.claims.size(), counts),
            begin_table({"verdict", "sentence", "measured on", "quantity", "measured", "expected"},
                        " class=\"claims\""),
            rows, end_table);
    }
    return text;
}

}  // namespace lostbits::output::report
