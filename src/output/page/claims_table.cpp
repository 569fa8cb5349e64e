#include "output/page/page.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "measure/claim/claim_columns.hpp"
#include "output/file/number_text.hpp"
#include "output/page/assets.hpp"
#include "output/page/sweep_data.hpp"
#include "output/page/text.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::output::page {

using measure::claim::ClaimResult;

namespace {

using scene::claim::Claim;
using scene::claim::SceneSubject;
using scene::claim::SweepSubject;
using State = ClaimResult::State;

template <class Part>
bool has_row(const Part& part, const Claim& c) {
    return std::ranges::find(part.rows, fmt::format("{}.{}", c.form, c.format)) != part.rows.end();
}

/// Position on the page of what a claim was measured on: the anchor of an element for readers without scripts, and the
/// view for other readers.
struct PagePosition {
    std::string anchor, view;
    bool is_drawn = true;  ///< the view shows the quantity that the claim is about
};

std::optional<PagePosition> position_in(const SceneSubject& subject, const Claim& c, const ClaimResult& r,
                                        const Report& report) {
    const auto part = std::ranges::find(report.maps, subject.name, &MapPart::id);
    if (part == report.maps.end() || !has_row(*part, c)) return {};
    std::string view = fmt::format("scene={}&form={}&format={}", subject.name, c.form, c.format);
    const measure::metric::Metric* const metric = claim::metric_of_column(c.metric);
    const bool is_drawn = metric == nullptr ? !measure::claim::asks_for_attribution(c)
                                            : std::ranges::find(part->metrics, metric->name) != part->metrics.end();
    if (metric != nullptr && is_drawn) view += fmt::format("&metric={}", metric->name);
    if (part->own_size && subject.pixel) view += fmt::format("&x={}&y={}", subject.pixel->first, subject.pixel->second);
    else if (part->own_size && subject.step) view += "&x=0&y=0";  // such a claim follows the march of that pixel
    else if (part->own_size && r.witness.x >= 0) view += fmt::format("&x={}&y={}", r.witness.x, r.witness.y);
    return PagePosition{"scene-" + subject.name, view, is_drawn};
}

/// `&u=…` and `&v=…`: the cell that a claim names, by the page's index: in the order of rising values, or of the cases.
/// Empty if the claim names no cell, or a value between two cells. Steps of a power of two are rounded to 12 bits and
/// claims are not, so |step − value| ≤ 2^-12 |value| counts as the same step.
std::string cell_of(const Claim& c, const SweepSubject& subject, const SweepPart& part) {
    if (const auto* const case_subject = subject.part_if<SweepSubject::Case>();
        case_subject && part.kind == SweepPart::Kind::cases) {
        const auto matches = [case_subject](const std::string& name) {
            return fnmatch(case_subject->name.c_str(), name.c_str(), 0) == 0;
        };
        const auto found = std::ranges::find_if(part.cases, matches);
        return found == part.cases.end() ? ""
                                         : fmt::format("&judged={}&v={}", intersect::convention_name(c.convention),
                                                       found - part.cases.begin());
    }
    std::string text;
    const auto* const point = subject.part_if<SweepSubject::At>();
    for (std::size_t a = 0; point && a < point->values.size(); ++a) {
        if (a >= part.axes.size()) return "";
        auto values = part.axes[a];
        std::ranges::sort(values);
        const auto found = std::ranges::find_if(
            values, [x = point->values[a]](double value) { return std::fabs(value - x) <= 0x1p-12 * std::fabs(x); });
        if (found == values.end()) return "";
        text += fmt::format("&{}={}", a == 0 ? "u" : "v", found - values.begin());
    }
    return text;
}

std::optional<PagePosition> position_in(const SweepSubject& subject, const Claim& c, const Report& report) {
    const std::string id = std::filesystem::path(subject.name).stem().string();
    const auto part = std::ranges::find(report.sweeps, id, &SweepPart::id);
    if (part == report.sweeps.end() || !has_row(*part, c)) return {};
    std::string view = fmt::format("sweep={}&form={}&format={}", id, c.form, c.format);
    const std::string column = c.onset == "lost_bits" ? "lost_bits_" + c.statistic
                               : c.onset.empty()      ? c.metric
                                                      : c.onset + "_fraction";
    if (std::ranges::find(sweep_statistics, column) != sweep_statistics.end()) view += "&statistic=" + column;
    return PagePosition{"sweep-" + id, view + cell_of(c, subject, *part)};
}

std::optional<PagePosition> position_of(const Claim& c, const ClaimResult& r, const Report& report) {
    if (const auto* const scene = c.on<SceneSubject>()) return position_in(*scene, c, r, report);
    if (const auto* const sweep = c.on<SweepSubject>()) return position_in(*sweep, c, report);
    return {};
}

/// Subject of a claim: a link to its position on the page, or the command that shows it.
std::string subject_cell(const Claim& c, const ClaimResult& r, const Report& report) {
    const claim::SubjectTexts texts = claim::words_of(c);
    const std::string text = html(texts.where),
                      row = fmt::format("<br><small>{} {}</small>", html(c.tested()), html(c.format));
    const auto position = position_of(c, r, report);
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
VerdictLabel verdict_label(const Claim& c, const ClaimResult& r) {
    switch (r.state) {
        case State::agrees: return {std::string(name_of(c.verdict)), name_of(c.verdict)};
        case State::disagrees: return {claim::changed_text(c, r), "differs"};
        case State::unmeasurable: return {"could not be measured", "differs"};
        case State::skipped: break;
    }
    return {"skipped", "skipped"};
}

/// Adds positions at which a long line may break: `<wbr>` after each underscore.
std::string with_line_breaks(std::string text) {
    for (std::size_t position = 0; (position = text.find('_', position)) != std::string::npos; position += 6)
        text.insert(position + 1, "<wbr>");
    return text;
}

/// Measured number, and its range over the draws.
std::string measured_cell(const ClaimResult& r) {
    if (r.state != State::agrees && r.state != State::disagrees) return html(r.reason);
    if (!r.is_random()) return shown(r.measured);
    const auto spread = r.spread();
    const std::string draws = r.further_measured.empty()  ? ""
                              : spread.low == spread.high ? fmt::format("in each of {} draws ", spread.draws)
                                                          : fmt::format("{} to {} over {} draws ", shown(spread.low),
                                                                        shown(spread.high), spread.draws);
    return fmt::format("{}<br><small>{}of {} random samples</small>", shown(r.measured), draws, r.samples);
}

std::string tile(std::size_t n, const char* text, const char* style) {
    return fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", style, n, text);
}

}  // namespace

std::string verdict_tiles(const claim::VerdictCounts& n) {
    std::string text = "<ul class=\"tiles\" id=\"verdicts\">";
    if (n.differing) text += tile(n.differing, "failed", "differs");
    if (n.broken) text += tile(n.broken, "could not be measured", "differs");
    text += tile(n.held, "hold", "holds");
    if (n.qualified) text += tile(n.qualified, "qualified", "qualified");
    text += tile(n.refuted, "refuted", "refuted");
    if (n.skipped) text += tile(n.skipped, "skipped on this machine", "skipped");
    return text + "</ul>\n";
}

namespace {

/// Keys by which the browser sorts a row: the gravest verdict first, then the number as measured.
std::string sort_keys(const VerdictLabel& label, const ClaimResult& r) {
    static constexpr std::array<std::string_view, 5> gravest{"differs", "refuted", "qualified", "holds", "skipped"};
    const auto gravity = std::ranges::find(gravest, label.style) - gravest.begin();
    const bool is_measured = r.state == State::agrees || r.state == State::disagrees;
    return fmt::format("data-grave=\"{}\" data-measured=\"{}\"", gravity, is_measured ? file::decimal(r.measured) : "");
}

/// `holds: a sample was measured`: the verdict and its evidence. Empty if no evidence is recorded.
std::string evidence_cell(const Claim& c, const ClaimResult& r, const VerdictLabel& label) {
    const std::string text = claim::floats_text(r) + (r.state == State::agrees ? claim::evidence_text(c, r) : "");
    return text.empty() ? "" : fmt::format("<br><small class=\"evidence\">{}: {}</small>", label.text, html(text));
}

/// `Shirley, section 9.3: <q>ignore hits</q> &middot; `: the source and its quotation. Empty if the claim is our own.
std::string source_text(const Claim& c) {
    if (!c.is_sourced()) return "";
    const std::string quoted = c.quotation.empty() ? "" : fmt::format(": <q>{}</q>", prose(c.quotation));
    return html(c.source) + quoted + " &middot; ";
}

std::string claim_row(const Claim& c, const ClaimResult& r, const Report& report) {
    const VerdictLabel label = verdict_label(c, r);
    std::string text = fmt::format(
        "<tr id=\"claim-{}\" class=\"{}\" {} data-command=\"{}\"><td class=\"verdict\">{}</td><td>{}", html(c.id),
        label.style, sort_keys(label, r), html(claim::words_of(c).command), label.text, prose(c.statement));
    if (!c.note.empty()) text += fmt::format("<br><em>{}</em>", prose(c.note));
    text += evidence_cell(c, r, label);
    text += fmt::format("<br><small>{}<code>{}</code></small></td>", source_text(c), html(c.id));
    return text + fmt::format(
                      "<td>{}</td><td data-name=\"quantity\">{}</td><td class=\"n\" data-name=\"measured\">{}</td><td "
                      "class=\"n\" data-name=\"expected\">{} to {}</td></tr>\n",
                      subject_cell(c, r, report), with_line_breaks(html(claim::quantity(c))), measured_cell(r),
                      shown(c.low),
                      shown(c.high) + (c.draws == 0 ? "" : fmt::format("<br><small>from {} draws</small>", c.draws)) +
                          (c.criterion ? fmt::format("<br><small>{}</small>", html(claim::says_text(c))) : ""));
}

/// `12 claims: 1 failed, 9 hold, 2 refuted`
std::string counts_text(std::size_t claims, const claim::VerdictCounts& n) {
    std::string text;
    const auto add = [&text](std::size_t count, const char* label, const char* style) {
        if (count == 0) return;
        text += fmt::format("{}<span class=\"{}\">{} {}</span>", text.empty() ? "" : ", ", style, count, label);
    };
    add(n.differing, "failed", "differs");
    add(n.broken, "could not be measured", "differs");
    add(n.held, n.held == 1 ? "holds" : "hold", "holds");
    add(n.qualified, "qualified", "qualified");
    add(n.refuted, "refuted", "refuted");
    add(n.skipped, "skipped", "skipped");
    return fmt::format("{}: {}", scene::toml::count_with_noun(claims, "claim"), text);
}

/// Title under which the page shows a subject; empty if the page does not show it.
std::string title_of(const std::string& subject, const Report& report) {
    const auto map = std::ranges::find(report.maps, subject, &MapPart::id);
    if (map != report.maps.end()) return map->title;
    const auto sweep = std::ranges::find(report.sweeps, std::filesystem::path(subject).stem().string(), &SweepPart::id);
    return sweep == report.sweeps.end() ? "" : sweep->title;
}

}  // namespace

std::string claims_table(const Report& report) {
    std::string text;
    for (const claim::ClaimSubject& subject : claim::subjects_of(report.claims)) {
        claim::VerdictCounts counts;
        std::string rows;
        for (const std::size_t i : subject.claims) {
            counts.add(report.claims[i], report.results[i]);
            rows += claim_row(report.claims[i], report.results[i], report);
        }
        const std::string title = title_of(subject.name, report);
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

}  // namespace lostbits::output::page
