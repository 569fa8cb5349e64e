// Tables of what a choice and offsets measured.
#include <fmt/format.h>

#include <cmath>

#include "output/file/number_text.hpp"
#include "output/offset/offset_files.hpp"
#include "output/offset/offset_sheet.hpp"
#include "output/page/page.hpp"
#include "output/page/text.hpp"

namespace lostbits::output::page {

using measure::choice::Candidate;
using measure::offset::both_sides;
using measure::offset::Side;

namespace {

/// `30.3 %`; a share of nothing is a dash, and 0 stands out as such.
std::string share_cell(double share) {
    if (std::isnan(share)) return "<td class=\"n\">&ndash;</td>";
    const std::string text = share == 0 ? "0" : share < 0.001 ? "&lt; 0.1 %" : fmt::format("{:.3g} %", 100 * share);
    return fmt::format("<td class=\"n\"><data value=\"{}\">{}</data></td>", file::decimal(share), text);
}

std::string header_row(const std::vector<std::string>& names) {
    std::string text = "<thead><tr>";
    for (const std::string& name : names) text += fmt::format("<th scope=\"col\">{}</th>", html(name));
    return text + "</tr></thead><tbody>\n";
}

/// What a column shows of a strategy.
struct StrategyColumn {
    const char *name, *column;
    bool share;
};
constexpr StrategyColumn strategy_columns[] = {{"rays wrong", "bad_fraction", true},
                                               {"self-hits", "self_hit_fraction", true},
                                               {"self-hits by the form", "self_hit_by_form_fraction", true},
                                               {"lost occluders", "lost_occluder_fraction", true},
                                               {"lost exits", "lost_exit_fraction", true},
                                               {"wrong side", "wrong_side_fraction", true},
                                               {"times larger, p50", "oversize_p50", false},
                                               {"p99", "oversize_p99", false}};

std::string caption_of(Side side) { return fmt::format("<caption>Rays {}</caption>", offset::in_words(side)); }

}  // namespace

std::string choice_table(const choice::Chosen& chosen) {
    std::string text = "<table>" + header_row({"form", "format", "registers", "ns a ray and solid", "bits kept",
                                               "rays wrong", "meets the wish"});
    for (const std::size_t k : measure::choice::by_price(chosen.all)) {
        const Candidate& c = chosen.all[k];
        text += fmt::format("<tr{}><th scope=\"row\">{}</th><td>{}</td><td>{}</td>",
                            chosen.meets == k ? " class=\"chosen\"" : "", html(c.row.form->info->name),
                            c.row.format.name, c.isa == "scalar" ? "one ray" : fmt::format("{} bits", c.isa));
        text += fmt::format("<td class=\"n\">{:.2f}</td><td class=\"n\">{}</td>", c.time.median * 1e9,
                            std::isnan(c.worth.kept_bits) ? "&ndash;" : fmt::format("{:.1f}", c.worth.kept_bits));
        text += share_cell(c.worth.wrong_fraction());
        text += fmt::format("<td>{}</td></tr>\n", chosen.meets == k                    ? "yes: chosen"
                                                  : c.worth.meets(chosen.request.wish) ? "yes"
                                                                                       : "no");
    }
    return text + "</tbody></table>\n";
}

std::string offset_table(const measure::offset::OffsetRequest& request, const measure::offset::OffsetSummary& summary) {
    std::string text = "<div class=\"pair\">\n";
    for (const Side side : both_sides) {
        std::vector<std::string> names{"strategy"};
        for (const StrategyColumn& column : strategy_columns) names.emplace_back(column.name);
        text += "<table>" + caption_of(side) + header_row(names);
        for (std::size_t k = 0; k < request.strategies.size(); ++k) {
            text += fmt::format("<tr><th scope=\"row\">{}</th>", html(offset::short_name(*request.strategies[k])));
            for (const StrategyColumn& column : strategy_columns) {
                const double value = measure::offset::offset_value(summary, side, k, column.column, "the page");
                text += column.share ? share_cell(value) : fmt::format("<td class=\"n\">{}</td>", shown(value));
            }
            text += "</tr>\n";
        }
        text += "</tbody></table>\n";
    }
    return text + "</div>\n";
}

std::string offset_overview(const std::vector<OffsetPart>& parts) {
    std::string text = "<div class=\"pair\">\n";
    for (const Side side : both_sides) {
        const auto s = static_cast<std::size_t>(side);
        std::vector<std::string> names{"strategy"};
        for (const OffsetPart& p : parts) names.push_back(p.id);
        text += "<table>" + caption_of(side) + header_row(names);
        for (std::size_t k = 0; k < parts.front().strategies.size(); ++k) {
            text += fmt::format("<tr><th scope=\"row\">{}</th>", html(parts.front().strategies[k]));
            for (const OffsetPart& p : parts) text += share_cell(p.bad[s][k]);
            text += "</tr>\n";
        }
        text += "</tbody></table>\n";
    }
    return text + "</div>\n";
}

}  // namespace lostbits::output::page
