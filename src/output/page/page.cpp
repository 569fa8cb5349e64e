#include "output/page/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <sstream>

#include "output/map/map_colour.hpp"
#include "output/map/row_names.hpp"
#include "output/page/assets.hpp"
#include "output/page/claims_table.hpp"
#include "output/page/sweep_data.hpp"
#include "output/page/text.hpp"

namespace lostbits::output::page {

using measure::answer::Outcome;

namespace {

/// `'sha256-…'` of a content security policy.
std::string hash_source(const Asset& asset) {
    std::string bytes;
    for (std::size_t i = 0; i + 1 < asset.sha256.size(); i += 2)
        bytes += static_cast<char>(std::stoi(std::string(asset.sha256.substr(i, 2)), nullptr, 16));
    return fmt::format("'sha256-{}'", base64(bytes));
}

/// Nothing may be fetched, and of scripts and styles only those run that the program was built with.
std::string policy() {
    std::string scripts = hash_source(page_script), styles = hash_source(page_style);
    if (!plot_script.text.empty()) {
        scripts = fmt::format("{} {}", scripts, hash_source(plot_script));
        styles = fmt::format("{} {}", styles, hash_source(plot_style));
    }
    return fmt::format(
        "default-src 'none'; script-src {}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'", scripts,
        styles);
}

std::string image(const Picture& p) {
    return p.png.empty() ? std::string()
                         : fmt::format("<img{} alt=\"{}\" src=\"data:image/png;base64,{}\">\n",
                                       p.is_plot ? " class=\"plotted\"" : "", html(p.alt), base64(p.png));
}

std::string images(const std::vector<Picture>& pictures) {
    std::string text;
    for (const Picture& p : pictures) text += image(p);
    return text;
}

std::string without_scripts(const std::vector<Picture>& pictures) {
    return fmt::format("<noscript>{}</noscript>\n", images(pictures));
}

/// Pictures for a page without scripts; where uPlot is missing, for every page.
std::string instead_of_plots(const std::vector<Picture>& pictures) {
    return plot_script.text.empty() ? images(pictures) : without_scripts(pictures);
}

/// Where they are pictures for every reader: why, and what to do about it.
std::string why_no_plots() {
    if (!plot_script.text.empty()) return "";
    return "<p class=\"no-plots\">The plots are pictures, since uPlot was not there when lostbits was built. To draw "
           "them "
           "here, with the numbers of each point: install npm, and type <code>./run</code> (or <code>npm ci "
           "--omit=dev</code>, and build again) in the folder of lostbits.</p>\n";
}

/// The colours of the PNGs: the ramp, the outcomes and the hit without a value.
Json colours_json() {
    image::ImageBackend& backend = image::image_backend();
    std::string ramp;
    for (const image::Rgb8& c : backend.ramp("viridis", 256)) ramp += fmt::format("{:02x}{:02x}{:02x}", c.r, c.g, c.b);
    Json outcomes = Json::array();
    for (std::size_t o = 0; o < image::outcome_colours.size(); ++o)
        outcomes.push_back(Json::array({measure::answer::outcome_names[o], colour_json(image::outcome_colours[o])}));
    const image::ColourScale any("viridis", backend.ramp("viridis", 2), 0, 1);
    return {{"ramp", ramp},
            {"outcomes", std::move(outcomes)},
            {"no_value",
             colour_json(map::pixel_colour(any, Outcome::agree_hit, std::numeric_limits<double>::quiet_NaN()))}};
}

const char* kind_name(SweepPart::Kind kind) {
    switch (kind) {
        case SweepPart::Kind::line: return "line";
        case SweepPart::Kind::plane: return "plane";
        case SweepPart::Kind::cases: break;
    }
    return "cases";
}

Json index_json(const Report& report) {
    Json json = colours_json();
    json["quantiles"] = array_of(measure::metric::quantiles, [](const auto& q) { return q.name; });
    json["least_agreement"] = measure::metric::least_agreement;
    json["maps"] = array_of(report.maps, [](const MapPart& m) { return m.index; });
    json["sweeps"] = array_of(report.sweeps, [](const SweepPart& s) {
        return Json{{"id", s.id}, {"title", s.title}, {"note", s.note}, {"kind", kind_name(s.kind)}, {"rows", s.rows}};
    });
    json["statistics"] = sweep_statistics;
    json["trades"] = array_of(report.trades, [](const TradePart& t) { return t.json; });
    return json;
}

std::string blob(const std::string& name, const std::string& packed) {
    return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", html(name), packed);
}

std::string about(const std::string& note, const std::string& source) {
    std::string text;
    if (!note.empty()) text += fmt::format("<p>{}</p>\n", html(note));
    if (!source.empty() && source != "-") text += fmt::format("<p class=\"source\">Source: {}</p>\n", html(source));
    return text;
}

std::string maps_section(const Report& report) {
    if (report.maps.empty()) return "";
    std::string text = "<section id=\"maps\"><h2>Maps</h2>\n<div id=\"map-view\" hidden></div>\n";
    for (const MapPart& m : report.maps) {
        text += fmt::format(
            "<details open class=\"part\" id=\"scene-{}\"><summary>{} "
            "<code>{}</code></summary>\n{}{}<noscript>{}</noscript></details>\n",
            html(m.id), html(m.title), html(m.id), about(m.note, m.source), m.table, image(m.sheet));
    }
    return text + "</section>\n";
}

std::string sweeps_section(const Report& report) {
    if (report.sweeps.empty()) return "";
    std::string text = "<section id=\"sweeps\"><h2>Sweeps</h2>\n<div id=\"sweep-view\" hidden></div>\n";
    if (std::ranges::any_of(report.sweeps, [](const SweepPart& s) { return s.kind == SweepPart::Kind::line; }))
        text += why_no_plots();
    for (const SweepPart& s : report.sweeps) {
        text += fmt::format(
            "<details open class=\"part\" id=\"sweep-{}\"><summary>{} <code>{}</code></summary>\n{}{}{}</details>\n",
            html(s.id), html(s.title), html(s.id), about(s.note, s.source), s.table,
            s.kind == SweepPart::Kind::line ? instead_of_plots(s.pictures) : without_scripts(s.pictures));
    }
    return text + "</section>\n";
}

std::string machine_of(const Report& report) {
    return fmt::format(
        "Times were measured briefly by the run that made this page, on its machine{}. Another run "
        "measures other times.",
        report.processor.empty() ? "" : fmt::format(" ({})", html(report.processor)));
}

std::string trades_section(const Report& report) {
    if (report.trades.empty()) return "";
    std::string text = fmt::format(
        "<section id=\"trade\"><h2>Speed against accuracy</h2>\n<p>{}</p>\n<div id=\"trade-view\" hidden></div>\n",
        machine_of(report));
    text += why_no_plots();
    for (const TradePart& t : report.trades) {
        text += fmt::format("<details open class=\"part\"><summary>{}</summary><pre>{}</pre>{}</details>\n",
                            html(t.shape), html(t.words), instead_of_plots(t.pictures));
    }
    return text + "</section>\n";
}

std::string choices_section(const Report& report) {
    if (report.choices.empty()) return "";
    std::string text = fmt::format(
        "<section id=\"choose\"><h2>The cheapest form that meets a wish</h2>\n<p>Every form and format on a scene's "
        "own "
        "rays. {}</p>\n",
        machine_of(report));
    for (const ChoicePart& c : report.choices) {
        text += fmt::format(
            "<details open class=\"part\"><summary>{} <code>{}</code></summary>\n<pre "
            "class=\"words\">{}</pre>\n{}{}</details>\n",
            html(c.wish), html(c.scene), html(c.words), image(c.front), c.table);
    }
    return text + "</section>\n";
}

/// Words with the lines of a diff marked.
std::string with_diffs(const std::string& words) {
    std::string text;
    std::istringstream lines(words);
    for (std::string line; std::getline(lines, line);) {
        const char* const tag = line.starts_with("    - ") ? "del" : line.starts_with("    + ") ? "ins" : nullptr;
        text += tag ? fmt::format("<{0}>{1}</{0}>\n", tag, html(line)) : html(line) + "\n";
    }
    return text;
}

std::string mends_section(const Report& report) {
    if (report.mends.empty()) return "";
    std::string text =
        "<section id=\"mend\"><h2>What to change in a form</h2>\n<p>The fewest operations that must be done in wider "
        "arithmetic so that a form meets a wish on every ray, and other ways of writing it that are the same without "
        "rounding.";
    if (std::ranges::any_of(report.mends, &MendPart::timed)) text += " " + machine_of(report);
    text += "</p>\n";
    for (const MendPart& m : report.mends) {
        text += fmt::format("<details open class=\"part\"><summary>{}: {} <code>{}</code></summary>\n<ul>\n",
                            html(m.form), html(m.wish), html(m.scene));
        for (const std::string& change : m.changes) text += fmt::format("<li>{}</li>\n", html(change));
        text += fmt::format("</ul>\n{}{}<pre class=\"words\">{}</pre></details>\n", m.table, image(m.front),
                            with_diffs(m.words));
    }
    return text + "</section>\n";
}

std::string offsets_section(const Report& report) {
    if (report.offsets.empty()) return "";
    std::string text = fmt::format(
        "<section id=\"offsets\"><h2>Origins of the next ray</h2>\n<p>A ray that leaves a computed point may meet the "
        "solid that it leaves once more, so renderers move its origin. Too short a move leaves such self-hits, too "
        "long "
        "a one jumps past a neighbour or through a thin solid. Here the points are those that {} computes in {}, of "
        "boxes {}. Of every strategy, the share of rays that go wrong (a start on the wrong side alone does no harm, "
        "and "
        "does not count):</p>\n",
        measure::offset::usual_forms[0], measure::offset::usual_format, measure::offset::usual_forms[1]);
    text += "<div class=\"wide\">" + offset_overview(report.offsets) + "</div>\n";
    for (const OffsetPart& o : report.offsets) {
        text += fmt::format(
            "<details open class=\"part offsets\" id=\"offsets-{}\"><summary>{} <code>{}</code></summary>\n{}",
            html(o.id), html(o.title), html(o.id), about(o.note, o.source));
        for (const std::string& line : o.words) text += fmt::format("<p>{}</p>\n", html(line));
        text += o.table + image(o.sheet) + "</details>\n";
    }
    return text + "</section>\n";
}

std::string counted(std::size_t n, const char* thing) { return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s"); }

/// What the page is.
constexpr const char* what_it_is =
    "This page shows where ray intersectors lose significand bits, and which of their operations lose them. Every form "
    "answered the same rays in each format, and each answer is compared with the true one, which is proved.";

/// What to do with it first.
std::string what_to_do(const Report& report) {
    if (!report.maps.empty())
        return "<b>First</b>, choose a scene and a form under <a href=\"#maps\">Maps</a> and point at the picture: the "
               "numbers of that ray stand beside it. A click keeps them. The buttons below the picture lead to rays "
               "whose operations are listed.";
    if (!report.sweeps.empty())
        return "<b>First</b>, choose a statistic under <a href=\"#sweeps\">Sweeps</a> and point at a line or a cell: "
               "its numbers stand beside it.";
    if (!report.claims.empty())
        return "<b>First</b>, open a subject under <a href=\"#claims\">Claims</a>: each sentence stands beside the "
               "number that was measured for it.";
    if (!report.mends.empty())
        return "<b>First</b>, read under <a href=\"#mend\">Changes</a> what each of them keeps, and the lines to "
               "write.";
    return "";
}

/// How the claims came out, and what the words mean.
std::string verdicts(const Report& report) {
    if (report.claims.empty()) return "";
    const claim::CountsBySource by_source = claim::count_verdicts(report.claims, report.results);
    const claim::VerdictCounts& n = by_source.all;
    std::string text =
        fmt::format("<p>{} measured again:</p>\n", counted(report.claims.size(), "claim")) + verdict_tiles(n);
    std::string meaning = by_source.text() + ". ";
    meaning.front() = static_cast<char>(std::toupper(meaning.front()));
    if (n.qualified > 0) meaning += "Qualified: the sentence is true with a condition that its source does not state. ";
    if (n.refuted > 0) meaning += "Refuted: the measurement contradicts the sentence, as was found before.";
    if (n.differing + n.broken > 0) meaning += " Failed: the measurement is no longer what was found before.";
    return fmt::format("{}<p class=\"hint\">{}</p>\n", text, meaning);
}

std::string claims_section(const Report& report) {
    if (report.claims.empty()) return "";
    return "<section id=\"claims\"><h2>Claims</h2>\n" + verdicts(report) + "<div id=\"claim-view\" hidden></div>\n" +
           claims_table(report) + "</section>\n";
}

/// What was typed; last, since it is the result that is looked for first.
std::string made_section(const Report& report) {
    const std::string what =
        report.maps.empty() && report.sweeps.empty()
            ? ""
            : fmt::format("{}, {}. ", counted(report.maps.size(), "map"), counted(report.sweeps.size(), "sweep"));
    return fmt::format(
        "<section id=\"made\"><h2>The command</h2>\n<p>{}Made by:</p>\n<pre class=\"words\">{}</pre></section>\n", what,
        html(report.command));
}

std::string heading(const Report& report) {
    std::string text =
        fmt::format("<header><h1>lostbits report</h1>\n<p id=\"opening\">{} {}</p>\n", what_it_is, what_to_do(report));
    text += "<nav>";
    if (!report.maps.empty()) text += "<a href=\"#maps\">Maps</a> ";
    if (!report.sweeps.empty()) text += "<a href=\"#sweeps\">Sweeps</a> ";
    if (!report.trades.empty()) text += "<a href=\"#trade\">Speed</a> ";
    if (!report.choices.empty()) text += "<a href=\"#choose\">Choice</a> ";
    if (!report.mends.empty()) text += "<a href=\"#mend\">Changes</a> ";
    if (!report.offsets.empty()) text += "<a href=\"#offsets\">Offsets</a> ";
    if (!report.claims.empty()) text += "<a href=\"#claims\">Claims</a> ";
    text += "<a href=\"#made\">Command</a></nav>\n";
    return text +
           "<noscript><p>Without scripts this page shows tables and contact sheets. With scripts it shows "
           "every pixel.</p></noscript></header>\n";
}

}  // namespace

std::string page(const Report& report) {
    std::string text = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta "
        "http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><meta name=\"referrer\" "
        "content=\"no-referrer\">\n<title>lostbits report</title>\n"
        "<link rel=\"icon\" href=\"data:,\">\n",
        policy());
    if (!report.program.empty())
        text += fmt::format("<meta name=\"generator\" content=\"{}\">\n", html(report.program));
    text += fmt::format("<style>{}</style>\n", page_style.text);
    if (!plot_style.text.empty()) text += fmt::format("<style>{}</style>\n", plot_style.text);
    text += "</head><body>\n" + heading(report) + "<main>\n" + maps_section(report) + sweeps_section(report) +
            trades_section(report) + choices_section(report) + mends_section(report) + offsets_section(report) +
            claims_section(report) + made_section(report) + "</main>\n";
    text += fmt::format("<script type=\"application/json\" id=\"index\">{}</script>\n", text_of(index_json(report)));
    for (const MapPart& m : report.maps) {
        for (const Blob& b : m.blobs) text += blob(b.name, b.packed);
    }
    for (const SweepPart& s : report.sweeps) {
        text += blob("sweep:" + s.id, pack(text_of(s.json)));
    }
    if (!plot_script.text.empty())
        text += fmt::format("<!-- The plots are drawn by uPlot:\n{}-->\n<script>{}</script>\n", plot_licence.text,
                            plot_script.text);
    text += fmt::format("<script>{}</script>\n</body></html>\n", page_script.text);
    return text;
}

}  // namespace lostbits::output::page
