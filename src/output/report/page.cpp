#include "output/report/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <sstream>

#include "output/file/base64.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_colour.hpp"
#include "output/report/assets.hpp"
#include "output/report/sweep_data.hpp"
#include "output/report/text.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::report {

using measure::answer::Outcome;
using text::count_with_noun;

namespace {

/// Source expression for a content security policy: `'sha256-…'`.
std::string hash_source(const Asset& asset) {
    std::string bytes;
    for (std::size_t i = 0; i + 1 < asset.sha256.size(); i += 2)
        bytes += static_cast<char>(std::stoi(std::string(asset.sha256.substr(i, 2)), nullptr, 16));
    return fmt::format("'sha256-{}'", file::encode_base64(bytes));
}

/// Policy that lets the page fetch nothing, and run only the scripts and styles built into the program.
std::string content_policy() {
    return fmt::format(
        "default-src 'none'; script-src {}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'",
        hash_source(page_script), hash_source(page_style));
}

std::string image_html(const Picture& p) {
    return p.png.empty() ? std::string()
                         : fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n", html(p.alt),
                                       file::encode_base64(p.png));
}

std::string noscript_image_html(const Picture& picture) {
    return fmt::format("<noscript>{}</noscript>\n", image_html(picture));
}

/// Chart as every reader sees it, with or without scripts. The script finds it by its name.
std::string figure_html(const Chart& c) {
    return c.svg.empty() ? std::string()
                         : fmt::format(
                               "<figure class=\"chart{}\" data-chart=\"{}\" role=\"group\" "
                               "aria-label=\"{}\"><p class=\"hint sideways\">The chart continues to the right: "
                               "scroll it sideways.</p>{}</figure>\n",
                               c.is_plot ? " plotted" : "", html(c.name), html(c.alt), c.svg);
}

std::string figures_html(const std::vector<Chart>& charts) {
    std::string text;
    for (const Chart& c : charts) text += figure_html(c);
    return text;
}

/// Colours of the PNGs: the ramp, the outcomes, and a hit without a value.
Json colours_json() {
    std::string ramp;
    for (const image::Rgb8& c : image::image_backend().ramp("viridis", 256))
        ramp += fmt::format("{:02x}{:02x}{:02x}", c.r, c.g, c.b);
    Json outcomes = Json::array();
    for (std::size_t o = 0; o < image::outcome_colours.size(); ++o)
        outcomes.push_back(Json::array({measure::answer::outcome_names[o], colour_json(image::outcome_colours[o])}));
    const image::ColourScale any_scale("viridis", image::image_backend().ramp("viridis", 2), 0, 1);
    return {{"ramp", ramp},
            {"outcomes", std::move(outcomes)},
            {"no_value",
             colour_json(map::pixel_colour(any_scale, Outcome::agree_hit, std::numeric_limits<double>::quiet_NaN()))}};
}

constexpr std::array kind_names{"line", "plane", "cases"};  // names of `SweepSection::Kind`

Json index_json(const Report& report) {
    Json json = colours_json();
    json["quantiles"] = json_array(measure::metric::quantile_statistics, [](const auto& q) { return q.name; });
    json["least_agreement"] = measure::metric::min_agreement;
    json["maps"] = json_array(report.maps, [](const MapSection& section) { return section.index; });
    json["sweeps"] = json_array(report.sweeps, [](const SweepSection& section) {
        return Json{{"id", section.id},
                    {"title", section.title},
                    {"note", section.note},
                    {"kind", kind_names[static_cast<std::size_t>(section.kind)]},
                    {"charts", json_array(section.charts, [](const Chart& c) { return c.name; })},
                    {"rows", section.tested_form_names}};
    });
    json["statistics"] = sweep_statistics;
    json["trades"] = json_array(report.trades, [](const TradeSection& section) { return section.json; });
    return json;
}

std::string blob_html(const std::string& name, const std::string& packed) {
    return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", html(name), packed);
}

std::string note_and_source(const std::string& note, const std::string& source) {
    std::string text;
    if (!note.empty()) text += fmt::format("<p>{}</p>\n", prose_html(note));
    if (!source.empty() && source != "-") text += fmt::format("<p class=\"source\">Source: {}</p>\n", html(source));
    return text;
}

/// Element that the reader can open and close: a summary, and a body below it. Links lead to `id`, if it is not empty.
std::string details_html(const std::string& id, const std::string& summary, const std::string& body) {
    return fmt::format("<details open class=\"part\"{}><summary>{}</summary>\n{}</details>\n",
                       id.empty() ? "" : fmt::format(" id=\"{}\"", html(id)), summary, body);
}

std::string title_with_name(const std::string& title, const std::string& name) {
    return fmt::format("{} <code>{}</code>", html(title), html(name));
}

std::string preformatted_html(const std::string& content) {
    return fmt::format("<pre class=\"words\">{}</pre>\n", content);
}

std::string maps_body(const std::vector<MapSection>& maps) {
    if (maps.empty()) return "";
    std::string text = "<div id=\"map-view\" hidden></div>\n";
    for (const MapSection& section : maps)
        text += details_html(
            "scene-" + section.id, title_with_name(section.title, section.id),
            note_and_source(section.note, section.source) + section.table + noscript_image_html(section.sheet));
    return text;
}

std::string sweeps_body(const std::vector<SweepSection>& sweeps) {
    if (sweeps.empty()) return "";
    std::string text = "<div id=\"sweep-view\" hidden></div>\n";
    for (const SweepSection& section : sweeps)
        text +=
            details_html("sweep-" + section.id, title_with_name(section.title, section.id),
                         note_and_source(section.note, section.source) + section.table + figures_html(section.charts));
    return text;
}

std::string timing_note(const Report& report) {
    return fmt::format(
        "Times were measured briefly by the run that made this page, on its machine{}. Another run "
        "measures other times.",
        report.processor.empty() ? "" : fmt::format(" ({})", html(report.processor)));
}

std::string trades_body(const Report& report) {
    if (report.trades.empty()) return "";
    std::string text = fmt::format("<p>{}</p>\n<div id=\"trade-view\" hidden></div>\n", timing_note(report));
    for (const TradeSection& section : report.trades)
        text += details_html("trade-" + section.shape, html(section.shape),
                             fmt::format("<pre>{}</pre>", html(section.text)) + figures_html(section.charts));
    return text;
}

std::string second_line(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    std::getline(lines, line);
    return line;
}

std::string choices_body(const Report& report) {
    if (report.choices.empty()) return "";
    std::string text =
        fmt::format("<p>Every form and format, measured on the scene's own rays. {}</p>\n", timing_note(report));
    for (const ChoiceSection& c : report.choices)
        text += details_html("", title_with_name(c.requirement, c.scene) + "<br>" + html(second_line(c.text)),
                             preformatted_html(html(c.text)) + figure_html(c.front_chart) + c.table);
    return text;
}

/// Marks the removed and added lines of a diff.
std::string mark_diff_lines(const std::string& diff) {
    std::string text;
    std::istringstream lines(diff);
    for (std::string line; std::getline(lines, line);) {
        const char* const tag = line.starts_with("    - ") ? "del" : line.starts_with("    + ") ? "ins" : nullptr;
        text += tag ? fmt::format("<{0}>{1}</{0}>\n", tag, html(line)) : html(line) + "\n";
    }
    return text;
}

/// Removes repeated sentences, because different changes may have the same one.
std::vector<std::string> distinct_sentences(const std::vector<std::string>& sentences) {
    std::vector<std::string> result;
    for (const std::string& sentence : sentences) static_cast<void>(map::find_or_add(result, sentence));
    return result;
}

std::string mends_body(const Report& report) {
    if (report.mends.empty()) return "";
    std::string text =
        "<p>The fewest operations that must be done in wider arithmetic so that a form meets a requirement on every "
        "ray, and other ways to write it that give the same result without rounding.";
    if (std::ranges::any_of(report.mends, &MendSection::has_times)) text += " " + timing_note(report);
    text += "</p>\n";

    for (const MendSection& m : report.mends) {
        std::string changes;
        for (const std::string& change : distinct_sentences(m.changes))
            changes += fmt::format("<li>{}</li>\n", html(change));
        text += details_html("", title_with_name(m.form + ": " + m.requirement, m.scene),
                             fmt::format("<ul>\n{}</ul>\n", changes) + m.table + figure_html(m.front_chart) +
                                 preformatted_html(mark_diff_lines(m.text)));
    }
    return text;
}

/// A study of a scene under a heading: its texts, table and sheet.
std::string study_html(const StudySection& section, const std::string& element_id, const std::string& heading) {
    std::string body;
    if (!section.purpose.empty()) body += fmt::format("<p>{}.</p>\n", html(section.purpose));
    body += note_and_source(section.note, section.source);
    for (const std::string& line : section.sentences) body += fmt::format("<p>{}</p>\n", html(line));
    return details_html(element_id, title_with_name(heading, section.id),
                        body + section.table + image_html(section.sheet));
}

std::string offsets_body(const std::vector<StudySection>& offsets) {
    if (offsets.empty()) return "";
    std::string text = fmt::format(
        "<p>A ray that leaves a computed point may hit the primitive that it leaves again, so renderers move its "
        "origin. A move that is too short leaves such self-hits. One that is too long jumps past a neighbour or "
        "through a thin primitive. Here the points are computed by {} in {}, and on boxes by {}. The tables give, for "
        "each strategy, the share of rays that go wrong (a start on the wrong side alone does no harm and does not "
        "count):</p>\n<div class=\"wide\">{}</div>\n",
        measure::offset::usual_forms()[0], measure::offset::usual_format, measure::offset::usual_forms()[1],
        offset_overview(offsets));

    for (const StudySection& section : offsets) text += study_html(section, "offsets-" + section.id, section.title);
    return text;
}

std::string studies_body(const std::vector<StudySection>& studies) {
    std::string text;
    for (const StudySection& section : studies)
        text += study_html(section, fmt::format("study-{}-{}", section.study, section.id),
                           fmt::format("{}: {}", section.study, section.title));
    return text;
}

/// First sentences of the page, which say what the page shows.
constexpr const char* opening_text =
    "This page shows where ray intersectors lose significand bits, and which of their operations lose them. Every form "
    "answered the same rays in each format, and each answer is compared with the proved true answer.";

/// Table of the findings of all maps: a row for each scene.
std::string results_table(const std::vector<MapSection>& maps) {
    if (maps.empty()) return "";
    std::string text = begin_table({"scene", "result", "forms and formats with wrong decisions"}, " id=\"results\"");
    for (const MapSection& section : maps)
        text += fmt::format(
            "<tr><th scope=\"row\"><a class=\"jump\" href=\"#scene-{0}\" data-view=\"scene={0}\">{1}"
            "</a></th><td>{2}</td><td class=\"n\">{3} of {4}</td></tr>\n",
            html(section.id), html(section.title), html(section.finding), section.wrong_row_count,
            section.tested_form_names.size());
    return text + end_table;
}

/// Sentence that says what to do first.
std::string first_step(const Report& report) {
    if (!report.maps.empty())
        return "<b>First</b>, choose a scene and a form under <a href=\"#maps\">Maps</a> and point at the picture. The "
               "numbers of that ray appear beside it. A click keeps them. The list below the picture leads to rays "
               "whose operations are shown.";
    if (!report.sweeps.empty())
        return "<b>First</b>, choose a statistic under <a href=\"#sweeps\">Sweeps</a> and point at a line or a cell. "
               "Its numbers appear beside it.";
    if (!report.claims.empty())
        return "<b>First</b>, open a subject under <a href=\"#claims\">Claims</a>: each statement stands beside the "
               "number that was measured for it.";
    if (!report.mends.empty())
        return "<b>First</b>, read under <a href=\"#mend\">Changes</a> what each change keeps, and which lines to "
               "write.";
    return "";
}

/// Results of the claims, the meanings of the verdicts, and the claims.
std::string claims_body(const Report& report) {
    if (report.claims.empty()) return "";
    const check::CountsBySource counts_by_source = check::count_verdicts(report.claims, report.results);
    const check::VerdictCounts& counts = counts_by_source.all;

    // The counts as a sentence, and the meanings of the verdicts that occur.
    std::string meaning = counts_by_source.text() + ". ";
    meaning.front() = static_cast<char>(std::toupper(meaning.front()));
    if (counts.qualified > 0)
        meaning += "Qualified: the statement is true under a condition that its source does not state. ";
    if (counts.refuted > 0)
        meaning += "Refuted: the measurement contradicts the statement, as it did when the verdict was written.";
    if (counts.differing + counts.broken > 0) meaning += " Failed: the measurement differs from the recorded one.";

    return fmt::format(
        "<p>{} measured again:</p>\n{}<p class=\"hint\">{}</p>\n<div id=\"claim-view\" hidden></div>\n{}",
        count_with_noun(report.claims.size(), "claim"), verdict_tiles(counts), meaning, claims_table(report));
}

/// Command that made the page.
std::string command_body(const Report& report) {
    std::vector<std::string> parts;
    if (!report.maps.empty()) parts.push_back(count_with_noun(report.maps.size(), "map"));
    if (!report.sweeps.empty()) parts.push_back(count_with_noun(report.sweeps.size(), "sweep"));
    return fmt::format("<p>{}{}Made by:</p>\n", fmt::join(parts, ", "), parts.empty() ? "" : ". ") +
           preformatted_html(html(report.command));
}

/// A section of the page: its anchor, the text of the link to it, its title, and its HTML.
struct Section {
    const char *id, *link, *title;
    std::string body;
};

/// Sections that are not empty. The maps and sweeps come first, because readers look for the results first.
std::vector<Section> make_sections(const Report& report) {
    std::vector<Section> sections{
        {"maps", "Maps", "Maps", maps_body(report.maps)},
        {"sweeps", "Sweeps", "Sweeps", sweeps_body(report.sweeps)},
        {"trade", "Speed", "Speed against accuracy", trades_body(report)},
        {"choose", "Choice", "The cheapest form that meets a requirement", choices_body(report)},
        {"mend", "Changes", "What to change in a form", mends_body(report)},
        {"offsets", "Offsets", "Origins of the next ray", offsets_body(report.offsets)},
        {"studies", "Studies", "Studies", studies_body(report.studies)},
        {"claims", "Claims", "Claims", claims_body(report)},
        {"made", "Command", "The command", command_body(report)},
    };
    std::erase_if(sections, [](const Section& section) { return section.body.empty(); });
    return sections;
}

/// Elements of the page's body.
std::string body_html(const Report& report) {
    std::string links, text;
    for (const Section& section : make_sections(report)) {
        links += fmt::format("{}<a href=\"#{}\">{}</a>", links.empty() ? "" : " ", section.id, section.link);
        text += fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", section.id, section.title, section.body);
    }
    return fmt::format(
        "<header><h1>lostbits report</h1>\n<p id=\"opening\">{} {}</p>\n{}<nav>{}</nav>\n<noscript><p>Without scripts "
        "this page shows tables and contact sheets. With scripts it shows every pixel.</p></noscript></header>\n"
        "<main>\n{}</main>\n",
        opening_text, first_step(report), results_table(report.maps), links, text);
}

}  // namespace

std::string page(const Report& report) {
    // The head.
    std::string text = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta "
        "http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><meta name=\"referrer\" "
        "content=\"no-referrer\">\n<title>lostbits report</title>\n"
        "<link rel=\"icon\" href=\"data:,\">\n",
        content_policy());
    if (!report.program.empty())
        text += fmt::format("<meta name=\"generator\" content=\"{}\">\n", html(report.program));
    text += fmt::format("<style>{}</style>\n", page_style.text);

    // The body, the data of the script, and the script.
    text += "</head><body>\n" + body_html(report);
    text +=
        fmt::format("<script type=\"application/json\" id=\"index\">{}</script>\n", compact_json(index_json(report)));
    for (const MapSection& section : report.maps) {
        for (const NamedData& b : section.named_data) text += blob_html(b.name, b.packed);
    }
    for (const SweepSection& section : report.sweeps)
        text += blob_html("sweep:" + section.id, pack(compact_json(section.json)));
    text += fmt::format("<script>{}</script>\n</body></html>\n", page_script.text);
    return text;
}

}  // namespace lostbits::output::report
