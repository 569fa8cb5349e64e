#include "output/report/claims_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "output/claim_files.hpp"
#include "output/number_text.hpp"
#include "output/report/sweep_data.hpp"
#include "output/report/text.hpp"

namespace lostbits::output::report {
namespace {

using scene::Claim;
using State = ClaimResult::State;

/// The metric whose statistic or fraction a claim is about: `lost_bits` of `lost_bits_p99`; empty for outcomes.
std::string metric_of(const std::string& column) {
    std::string_view best;
    for (const Metric& m : metrics()) {
        if (column.starts_with(m.name) && m.name.size() > best.size()) best = m.name;
    }
    return std::string(best);
}

template <class Part>
bool has_row(const Part& part, const Claim& c) {
    return std::ranges::find(part.rows, fmt::format("{}.{}", c.form, c.format)) != part.rows.end();
}

/// The view of the page that shows what a claim was measured on.
std::optional<std::string> view_of(const Claim& c, const ClaimResult& r, const Report& report) {
    if (!c.scene.empty()) {
        const auto part = std::ranges::find(report.maps, c.scene, &MapPart::id);
        if (part == report.maps.end() || !has_row(*part, c)) return {};
        std::string view = fmt::format("scene={}&form={}&format={}", c.scene, c.form, c.format);
        if (const std::string m = metric_of(c.metric); !m.empty()) view += "&metric=" + m;
        if (r.witness.x >= 0 && part->own_size) view += fmt::format("&x={}&y={}", r.witness.x, r.witness.y);
        return view;
    }
    if (c.sweep.empty()) return {};
    const std::string id = std::filesystem::path(c.sweep).stem().string();
    const auto part = std::ranges::find(report.sweeps, id, &SweepPart::id);
    if (part == report.sweeps.end() || !has_row(*part, c)) return {};
    if (part->json.empty()) return "sweep-" + id;
    std::string view = fmt::format("sweep={}&form={}&format={}", id, c.form, c.format);
    const std::string column = c.onset == "lost_bits" ? "lost_bits_" + c.statistic : c.onset.empty() ? c.metric : c.onset + "_fraction";
    if (std::ranges::any_of(sweep_statistics(), [&](const Statistic& s) { return s.name == column; })) view += "&statistic=" + column;
    return view;
}

struct Word {
    const char *text, *style;
};
Word word_of(const Claim& c, const ClaimResult& r) {
    switch (r.state) {
        case State::agrees: return c.verdict == Claim::Verdict::holds ? Word{"holds", "holds"} : Word{"refuted", "refuted"};
        case State::disagrees: return {"no longer measures as stated", "differs"};
        case State::broken: return {"could not be measured", "differs"};
        case State::skipped: break;
    }
    return {"skipped", "skipped"};
}

/// With places to break a long line.
std::string breakable(std::string text) {
    for (std::size_t at = 0; (at = text.find('_', at)) != std::string::npos; at += 6) text.insert(at + 1, "<wbr>");
    return text;
}

std::string tile(std::size_t n, const char* words, const char* style) { return fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", style, n, words); }

}  // namespace

VerdictCounts count_verdicts(const Report& report) {
    VerdictCounts n;
    for (std::size_t i = 0; i < report.claims.size(); ++i) {
        switch (report.results[i].state) {
            case State::agrees: ++(report.claims[i].verdict == Claim::Verdict::holds ? n.held : n.refuted); break;
            case State::disagrees: ++n.differing; break;
            case State::broken: ++n.broken; break;
            case State::skipped: ++n.skipped; break;
        }
    }
    return n;
}

std::string verdict_tiles(const VerdictCounts& n) {
    std::string text = "<ul class=\"tiles\" id=\"verdicts\">";
    if (n.differing) text += tile(n.differing, "no longer measure as stated", "differs");
    if (n.broken) text += tile(n.broken, "could not be measured", "differs");
    text += tile(n.held, "hold", "holds") + tile(n.refuted, "are refuted", "refuted");
    if (n.skipped) text += tile(n.skipped, "skipped on this machine", "skipped");
    return text + "</ul>\n";
}

std::string claims_table(const Report& report) {
    std::string text =
        "<table class=\"claims\"><thead><tr><th scope=\"col\">verdict</th><th scope=\"col\">sentence</th><th scope=\"col\">measured on</th>"
        "<th scope=\"col\">quantity</th><th scope=\"col\">measured</th><th scope=\"col\">expected</th></tr></thead><tbody>\n";
    for (std::size_t i = 0; i < report.claims.size(); ++i) {
        const Claim& c = report.claims[i];
        const ClaimResult& r = report.results[i];
        const Word word = word_of(c, r);
        std::string place = html(where_measured(c));
        if (const auto view = view_of(c, r, report)) place = fmt::format("<a class=\"jump\" href=\"#{}\">{}</a>", html(*view), place);
        const std::string what = quantity(c);
        text += fmt::format("<tr id=\"claim-{}\" class=\"{}\" data-command=\"{}\"><td class=\"verdict\">{}</td><td>{}", html(c.id), word.style, html(reproduce(c)), word.text, html(c.statement));
        if (!c.note.empty()) text += fmt::format("<br><em>{}</em>", html(c.note));
        text += fmt::format("<br><small>{}{}<code>{}</code></small></td>", c.source == "-" ? "" : html(c.source), c.source == "-" ? "" : " &middot; ", html(c.id));
        text += fmt::format("<td>{}<br><small>{} {}</small></td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{} to {}</td></tr>\n", place, html(c.form.empty() ? c.row : c.form),
                            html(c.format), breakable(html(what)), r.state == State::agrees || r.state == State::disagrees ? shown(r.measured) : html(r.trouble), shown(c.low), shown(c.high));
    }
    return text + "</tbody></table>\n";
}

}  // namespace lostbits::output::report
