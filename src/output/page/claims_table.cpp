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
/// view for the others.
struct Place {
    std::string anchor, view;
    bool drawn = true;  ///< the view shows the quantity itself
};

std::optional<Place> place_in(const SceneSubject& on, const Claim& c, const ClaimResult& r, const Report& report) {
    const auto part = std::ranges::find(report.maps, on.name, &MapPart::id);
    if (part == report.maps.end() || !has_row(*part, c)) return {};
    std::string view = fmt::format("scene={}&form={}&format={}", on.name, c.form, c.format);
    const measure::metric::Metric* const m = claim::metric_of_column(c.metric);
    const bool drawn = m == nullptr ? !measure::claim::asks_for_attribution(c)
                                    : std::ranges::find(part->metrics, m->name) != part->metrics.end();
    if (m != nullptr && drawn) view += fmt::format("&metric={}", m->name);
    if (part->own_size && on.pixel) view += fmt::format("&x={}&y={}", on.pixel->first, on.pixel->second);
    else if (part->own_size && on.step) view += "&x=0&y=0";  // such a claim follows the march of that pixel
    else if (part->own_size && r.witness.x >= 0) view += fmt::format("&x={}&y={}", r.witness.x, r.witness.y);
    return Place{"scene-" + on.name, view, drawn};
}

/// `&u=…` and `&v=…`: the cell that a claim names, as the page numbers it: by rising values, or by the order of the
/// cases. Empty if the claim names no cell, or a value between two cells. Steps of a power of two are rounded to 12
/// bits and claims are not, so |step − at| ≤ 2^-12 |at| counts as the same step.
std::string cell_of(const Claim& c, const SweepSubject& on, const SweepPart& part) {
    if (const auto* const one = on.part_if<SweepSubject::Case>(); one && part.kind == SweepPart::Kind::cases) {
        const auto named = [one](const std::string& name) { return fnmatch(one->name.c_str(), name.c_str(), 0) == 0; };
        const auto found = std::ranges::find_if(part.cases, named);
        return found == part.cases.end() ? ""
                                         : fmt::format("&judged={}&v={}", intersect::convention_name(c.convention),
                                                       found - part.cases.begin());
    }
    std::string text;
    const auto* const at = on.part_if<SweepSubject::At>();
    for (std::size_t a = 0; at && a < at->values.size(); ++a) {
        if (a >= part.axes.size()) return "";
        auto values = part.axes[a];
        std::ranges::sort(values);
        const auto found = std::ranges::find_if(
            values, [x = at->values[a]](double value) { return std::fabs(value - x) <= 0x1p-12 * std::fabs(x); });
        if (found == values.end()) return "";
        text += fmt::format("&{}={}", a == 0 ? "u" : "v", found - values.begin());
    }
    return text;
}

std::optional<Place> place_in(const SweepSubject& on, const Claim& c, const Report& report) {
    const std::string id = std::filesystem::path(on.name).stem().string();
    const auto part = std::ranges::find(report.sweeps, id, &SweepPart::id);
    if (part == report.sweeps.end() || !has_row(*part, c)) return {};
    std::string view = fmt::format("sweep={}&form={}&format={}", id, c.form, c.format);
    const std::string column = c.onset == "lost_bits" ? "lost_bits_" + c.statistic
                               : c.onset.empty()      ? c.metric
                                                      : c.onset + "_fraction";
    if (std::ranges::find(sweep_statistics, column) != sweep_statistics.end()) view += "&statistic=" + column;
    return Place{"sweep-" + id, view + cell_of(c, on, *part)};
}

std::optional<Place> place_of(const Claim& c, const ClaimResult& r, const Report& report) {
    if (const auto* const scene = c.on<SceneSubject>()) return place_in(*scene, c, r, report);
    if (const auto* const sweep = c.on<SweepSubject>()) return place_in(*sweep, c, report);
    return {};
}

/// Subject of a claim: a link to its place on the page, or the command that shows it.
std::string measured_on(const Claim& c, const ClaimResult& r, const Report& report) {
    const claim::SubjectTexts words = claim::words_of(c);
    const std::string text = html(words.where),
                      row = fmt::format("<br><small>{} {}</small>", html(c.tested()), html(c.format));
    const auto place = place_of(c, r, report);
    if (!place)
        return fmt::format("{}{}<br><small>not on this page: <code>{}</code></small>", text, row, html(words.command));
    const std::string link =
        fmt::format("<a class=\"jump\" href=\"#{}\"{}>{}</a>", html(place->anchor),
                    place->view.empty() ? "" : fmt::format(" data-view=\"{}\"", html(place->view)), text);
    return place->drawn ? link + row
                        : fmt::format("{}{}<br><small>to draw its picture: <code>{}</code></small>", link, row,
                                      html(words.command));
}

struct Word {
    std::string text;
    std::string_view style;
};
Word word_of(const Claim& c, const ClaimResult& r) {
    switch (r.state) {
        case State::agrees: return {std::string(name_of(c.verdict)), name_of(c.verdict)};
        case State::disagrees: return {claim::changed_text(c, r), "differs"};
        case State::broken: return {"could not be measured", "differs"};
        case State::skipped: break;
    }
    return {"skipped", "skipped"};
}

/// Adds places to break a long line: `<wbr>` after each underscore.
std::string breakable(std::string text) {
    for (std::size_t at = 0; (at = text.find('_', at)) != std::string::npos; at += 6) text.insert(at + 1, "<wbr>");
    return text;
}

/// The measured number, and its range over the draws.
std::string measured_cell(const ClaimResult& r) {
    if (r.state != State::agrees && r.state != State::disagrees) return html(r.trouble);
    if (!r.is_drawn()) return shown(r.measured);
    const auto s = r.spread();
    const std::string draws = r.further.empty() ? ""
                              : s.low == s.high
                                  ? fmt::format("in each of {} draws ", s.draws)
                                  : fmt::format("{} to {} over {} draws ", shown(s.low), shown(s.high), s.draws);
    return fmt::format("{}<br><small>{}of {} random samples</small>", shown(r.measured), draws, r.samples);
}

std::string tile(std::size_t n, const char* words, const char* style) {
    return fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", style, n, words);
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

/// Keys that the browser sorts a row by: the gravest verdict first, then the number as measured.
std::string sort_keys(const Word& word, const ClaimResult& r) {
    static constexpr std::array<std::string_view, 5> gravest{"differs", "refuted", "qualified", "holds", "skipped"};
    const auto grave = std::ranges::find(gravest, word.style) - gravest.begin();
    const bool measured = r.state == State::agrees || r.state == State::disagrees;
    return fmt::format("data-grave=\"{}\" data-measured=\"{}\"", grave, measured ? file::decimal(r.measured) : "");
}

/// `holds: a sample was measured`: the verdict and what it rests on. Empty if nothing says what it rests on.
std::string rests_on(const Claim& c, const ClaimResult& r, const Word& word) {
    const std::string text = claim::floats_text(r) + (r.state == State::agrees ? claim::evidence_text(c, r) : "");
    return text.empty() ? "" : fmt::format("<br><small class=\"evidence\">{}: {}</small>", word.text, html(text));
}

/// `Shirley, section 9.3: <q>ignore hits</q> &middot; `: the source and its words. Empty if the claim is our own.
std::string source_text(const Claim& c) {
    if (!c.is_sourced()) return "";
    const std::string quoted = c.quotation.empty() ? "" : fmt::format(": <q>{}</q>", prose(c.quotation));
    return html(c.source) + quoted + " &middot; ";
}

std::string claim_row(const Claim& c, const ClaimResult& r, const Report& report) {
    const Word word = word_of(c, r);
    std::string text = fmt::format(
        "<tr id=\"claim-{}\" class=\"{}\" {} data-command=\"{}\"><td class=\"verdict\">{}</td><td>{}", html(c.id),
        word.style, sort_keys(word, r), html(claim::words_of(c).command), word.text, prose(c.statement));
    if (!c.note.empty()) text += fmt::format("<br><em>{}</em>", prose(c.note));
    text += rests_on(c, r, word);
    text += fmt::format("<br><small>{}<code>{}</code></small></td>", source_text(c), html(c.id));
    return text + fmt::format(
                      "<td>{}</td><td data-name=\"quantity\">{}</td><td class=\"n\" data-name=\"measured\">{}</td><td "
                      "class=\"n\" data-name=\"expected\">{} to {}</td></tr>\n",
                      measured_on(c, r, report), breakable(html(claim::quantity(c))), measured_cell(r), shown(c.low),
                      shown(c.high) + (c.draws == 0 ? "" : fmt::format("<br><small>from {} draws</small>", c.draws)) +
                          (c.criterion ? fmt::format("<br><small>{}</small>", html(claim::says_text(c))) : ""));
}

/// `12 claims: 1 failed, 9 hold, 2 refuted`
std::string counts_text(std::size_t claims, const claim::VerdictCounts& n) {
    std::string text;
    const auto add = [&text](std::size_t count, const char* words, const char* style) {
        if (count == 0) return;
        text += fmt::format("{}<span class=\"{}\">{} {}</span>", text.empty() ? "" : ", ", style, count, words);
    };
    add(n.differing, "failed", "differs");
    add(n.broken, "could not be measured", "differs");
    add(n.held, n.held == 1 ? "holds" : "hold", "holds");
    add(n.qualified, "qualified", "qualified");
    add(n.refuted, "refuted", "refuted");
    add(n.skipped, "skipped", "skipped");
    return fmt::format("{}: {}", scene::toml::counted(claims, "claim"), text);
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
