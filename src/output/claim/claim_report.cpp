#include "output/claim/claim_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "measure/claim/claim_columns.hpp"
#include "output/blame/march_text.hpp"
#include "output/claim/claim_files.hpp"
#include "output/claim/claim_sheets.hpp"
#include "output/claim/subject_words.hpp"
#include "output/claim/verdict_counts.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "output/file/number_text.hpp"
#include "output/map/map_files.hpp"
#include "output/offset/offset_pictures.hpp"
#include "output/picture/render_pictures.hpp"
#include "output/sweep/case_files.hpp"
#include "output/sweep/sweep_plots.hpp"

namespace lostbits::output::claim {

using intersect::Touching;
using measure::claim::ClaimRequest;
using measure::claim::ClaimResult;
using measure::evaluate::TestedForm;
using scene::claim::Claim;
using scene::claim::ConsistencySubject;
using scene::claim::OffsetsSubject;
using scene::claim::RenderSubject;
using scene::claim::SceneSubject;
using scene::claim::SweepSubject;

std::vector<ClaimSubject> subjects_of(const std::vector<scene::claim::Claim>& claims) {
    std::vector<ClaimSubject> subjects;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        // One scene may be mapped for some claims, rendered for others, and the rays that leave it be the subject of
        // more.
        const std::string name = words_of(claims[i]).heading;
        auto found = std::ranges::find(subjects, name, &ClaimSubject::name);
        if (found == subjects.end()) found = subjects.insert(subjects.end(), {name, {}});
        found->claims.push_back(i);
    }
    return subjects;
}

namespace {

using State = ClaimResult::State;

/// What is shown of a subject, and of which claims about it.
struct ShownSubject {
    const std::filesystem::path& folder;
    std::vector<const Claim*> claims;
    const ClaimRequest& run;
};

/// The forms and formats that the claims name, each once, in the order of the catalogue.
std::vector<TestedForm> rows_of(const std::vector<const Claim*>& claims) {
    std::vector<TestedForm> rows;
    for (const Claim* const c : claims) {
        const TestedForm row = measure::claim::claim_row(*c);
        const auto same = [&](const TestedForm& r) {
            return r.form == row.form && r.format == row.format && r.judged == row.judged;
        };
        if (std::ranges::none_of(rows, same)) rows.push_back(row);
    }
    std::ranges::stable_sort(rows, {}, [known = intersect::table::catalogue()](const TestedForm& row) {
        const auto place = std::ranges::find(known, row.form->info, &intersect::table::Intersector::info);
        return std::pair(place - known.begin(), row.form->info->name);  // what is made at run time comes last, by name
    });
    return rows;
}

std::vector<const measure::metric::Metric*> drawn_metrics() {
    std::vector<const measure::metric::Metric*> all;
    for (const char* name : {"lost_bits", "ulp_error", "inherent_bits", "excess_bits"})
        all.push_back(measure::metric::find_metric(name));
    return all;
}

std::string picture_link(const std::string& title, const std::string& file) {
    return fmt::format("![{}](pictures/{})\n", file::markdown_text(title), file::markdown_path(file));
}

/// The marches along a scene's first pixel, sample by sample, where all claims are about those; else its picture.
std::string picture_of(const SceneSubject& on, const ShownSubject& shown) {
    const std::vector<TestedForm> rows = rows_of(shown.claims);
    const scene::file::Scene scene = shown_scene(on.name, shown.run);
    const auto traced = [](const Claim* c) { return c->on<SceneSubject>() && c->on<SceneSubject>()->step; };
    if (std::ranges::all_of(shown.claims, traced)) {
        const measure::answer::OneRay ray(scene, 0, 0, {.stop = shown.run.stop});
        std::string text;
        for (const TestedForm& row : rows)
            text += fmt::format("```\n{}```\n", blame::march_table(*row.form, row.format, ray));
        return text;
    }
    const measure::evaluate::EvaluationRequest request{.scene = &scene,
                                                       .rows = rows,
                                                       .metrics = {measure::metric::find_metric("lost_bits")},
                                                       .limit = {.stop = shown.run.stop}};
    const std::string file = scene.id + ".png";
    map::MapFiles sheet(
        request,
        {.folder = {}, .drawn = request.metrics, .named = scene.id, .sheet_alone = shown.folder / "pictures" / file});
    sheet.finish(measure::evaluate::evaluate_rows(request, sheet.sinks()));
    return picture_link(scene.title, file);
}

/// The pictures of a rendered scene, of all stages that its claims name.
std::string picture_of(const RenderSubject& on, const ShownSubject& shown) {
    const scene::file::Scene scene = shown_scene(on.name, shown.run);
    std::set<scene::file::Stage> stages;
    for (const Claim* const c : shown.claims)
        stages.insert(c->on<RenderSubject>()->stage.value_or(scene.appearance.furthest()));
    measure::picture::RenderRequest request{
        .scene = &scene, .stages = {stages.begin(), stages.end()}, .rows = {}, .limit = {.stop = shown.run.stop}};
    // Every form in every format that a claim names, for an empty place on the sheet reads as a format that the form
    // lacks.
    const std::vector<TestedForm> claimed = rows_of(shown.claims);
    for (const TestedForm& a : claimed) {
        for (const TestedForm& b : claimed) {
            const auto same = [&](const TestedForm& r) { return r.form == a.form && r.format == b.format; };
            if (a.form->exists_in(b.format) && std::ranges::none_of(request.rows, same))
                request.rows.push_back({a.form, b.format});
        }
    }
    const std::string file = scene.id + ".rendered.png";
    picture::RenderPictures sheet(request, shown.folder / "pictures" / file);
    sheet.finish(measure::picture::run_render(request, &sheet));
    return picture_link(scene.title, file);
}

/// The offsets of a scene: of each form, format and kind of point that its claims name.
std::string picture_of(const OffsetsSubject& on, const ShownSubject& shown) {
    const scene::file::Scene scene = shown_scene(on.name, shown.run);
    measure::offset::OffsetRequest request{.scene = &scene,
                                           .rows = {},
                                           .strategies = measure::offset::all_strategies(),
                                           .limit = {.stop = shown.run.stop},
                                           .quiet = false};
    for (const Claim* const c : shown.claims) {
        for (const auto point : {measure::offset::HitPoint::computed, measure::offset::HitPoint::projected}) {
            const measure::offset::OffsetRow row{measure::claim::claim_row(*c), point};
            if (name_of(point) == c->on<OffsetsSubject>()->points &&
                std::ranges::find(request.rows, row) == request.rows.end())
                request.rows.push_back(row);
        }
    }
    const std::string file = scene.id + ".offsets.png";
    offset::OffsetPictures sheet(request, shown.folder / "pictures" / file);
    sheet.finish(measure::offset::run_offsets(request, &sheet));
    return picture_link(scene.title, file);
}

/// All checks of consistency of a scene.
std::string picture_of(const ConsistencySubject& on, const ShownSubject& shown) {
    return picture_consistency(shown.folder, rows_of(shown.claims), on.name, shown.run);
}

/// Which plots of a sweep its claims are about.
struct SweepPlots {
    bool median = false, tail = false, wrong = false;
};

SweepPlots plots_of(const std::vector<const Claim*>& claims) {
    SweepPlots plots;
    for (const Claim* const c : claims) {
        const std::string& what = c->onset.empty() ? c->metric : c->onset;
        const std::string& statistic = c->onset.empty() ? c->metric : c->statistic;
        // Bits of an operation are lost bits somewhere.
        const bool bits = what.find("bits") != std::string::npos || measure::claim::asks_for_attribution(*c);
        plots.wrong |= !bits;
        const bool tail = statistic.ends_with("p99") || statistic.ends_with("max");
        plots.median |= bits && !tail;
        plots.tail |= bits && tail;
    }
    return plots;
}

/// The pictures of a sweep, as Markdown.
std::string picture_of(const SweepSubject& on, const ShownSubject& shown) {
    const auto& [folder, claims, run] = shown;
    const std::vector<TestedForm> rows = rows_of(claims);
    const auto path = scene::sweep::find_sweep(on.name, run.data_dir);
    // The claims are about small ranges; a picture would need the whole axis.
    if (scene::sweep::sweep_kind(path) == scene::sweep::SweepKind::every_float) return "";
    if (scene::sweep::sweep_kind(path) == scene::sweep::SweepKind::cases) {
        const scene::sweep::CaseFile file(path);
        const measure::sweep::CaseRequest request{
            .file = &file, .rows = rows, .metrics = drawn_metrics(), .limit = {.stop = run.stop}};
        const auto cases = measure::sweep::run_cases(request);
        std::string text;
        for (const std::optional<Touching> judged :
             {std::optional<Touching>{}, std::optional{Touching::hit}, std::optional{Touching::miss}}) {
            if (std::ranges::none_of(rows, [&](const TestedForm& r) { return r.judged == judged; })) continue;
            const std::string picture =
                judged ? fmt::format("{}.{}.png", file.id, intersect::convention_name(judged)) : file.id + ".png";
            sweep::write_case_matrix(folder / "pictures" / picture, request, cases, judged);
            text += picture_link(file.title, picture);
        }
        return text;
    }
    const scene::sweep::SweepFile sweep(path, run.data_dir);
    measure::sweep::SweepRequest request{
        .sweep = &sweep, .rows = rows, .metrics = drawn_metrics(), .limit = {.stop = run.stop}};
    for (TestedForm& row : request.rows) row.judged = row.judged ? row.judged : sweep.convention;
    const auto steps = measure::sweep::run_sweep(request);
    std::string text;
    if (sweep.axes.size() == 2) {
        for (std::size_t r = 0; r < rows.size(); ++r) {
            const std::string file =
                fmt::format("{}.{}.{}.png", sweep.id, rows[r].form->info->name, rows[r].format.name);
            sweep::write_plane_picture(folder / "pictures" / file, request, steps, r);
            text += picture_link(fmt::format("{} in {}", rows[r].form->info->name, rows[r].format.name), file);
        }
        return text;
    }
    const auto onsets = measure::sweep::find_onsets(request, steps);
    const sweep::MeasuredSweep measured{request, steps, onsets};
    const SweepPlots plots = plots_of(claims);
    for (const Format& format : sweep::formats_of(measured)) {
        const auto show = [&](const char* what) {
            const std::string file = fmt::format("{}.{}.{}.png", sweep.id, what, format.name);
            text += picture_link(fmt::format("{}: {}, {}", sweep.title, what, format.name), file);
            return folder / "pictures" / file;
        };
        if (plots.median) sweep::write_lost_bits_plot(show("lost_bits_p50"), measured, format, 0.5);
        if (plots.tail) sweep::write_lost_bits_plot(show("lost_bits_p99"), measured, format, 0.99);
        if (!plots.wrong) continue;
        for (const measure::answer::Outcome o : sweep::wrong_outcomes(measured, format))
            sweep::write_wrong_plot(show(measure::answer::outcome_names[static_cast<std::size_t>(o)].data()), measured,
                                    format, o);
    }
    return text;
}

std::string in_code(const std::vector<std::string>& all) {
    std::string text;
    for (const std::string& each : all) text += (text.empty() ? "" : ", ") + file::markdown_code(each);
    return text;
}

std::string rounded(double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x) : file::decimal(x); }

/// ` (0.44 to 0.47 over 4 draws)`, or ` (in each of 4 draws)`; empty where nothing is random, or only one draw was
/// measured.
std::string spread_text(const ClaimResult& r) {
    if (r.further.empty()) return "";
    const auto s = r.spread();
    if (s.low == s.high) return fmt::format(" (in each of {} draws)", s.draws);
    return fmt::format(" ({} to {} over {} draws)", rounded(s.low), rounded(s.high), s.draws);
}

/// ` (95 %: 5.1 to 6.2)`: of a 99th percentile of random rays.
std::string bounds_text(const ClaimResult& r) {
    return r.bounds ? fmt::format(" (95 %: {} to {})", rounded(r.bounds->low), rounded(r.bounds->high)) : "";
}

/// What the random claims of a subject rest on.
std::string samples_text(const ClaimSubject& subject, const std::vector<ClaimResult>& results) {
    for (const std::size_t i : subject.claims) {
        if (results[i].is_drawn())
            return fmt::format("*Random rays or numbers: each draw has {} independent samples.*\n\n",
                               results[i].samples);
    }
    return "";
}

/// ` --seeds 3`: what made the draws.
std::string draws_option(const std::vector<ClaimResult>& results) {
    std::size_t further = 0;
    for (const ClaimResult& r : results) further = std::max(further, r.further.size());
    return further == 0 ? "" : fmt::format(" --seeds {}", further);
}

std::string row_text(const Claim& c, const ClaimResult& r) {
    const std::string verdict =
        r.state == State::agrees
            ? (c.verdict == Claim::Verdict::refuted ? "**refuted**" : std::string(name_of(c.verdict)))
        : r.state == State::skipped ? "skipped"
                                    : fmt::format("**{}**", changed_text(c, r));
    // Expressions have stars.
    const std::string reach = r.state == State::agrees ? evidence_text(c, r) : "";
    const std::string all = floats_text(r) + (reach.empty() ? "" : file::markdown_text(reach)),
                      number = r.floats > 0 ? file::decimal(r.measured) : rounded(r.measured);
    const std::string what = c.operations.empty() ? file::markdown_text(quantity(c))
                                                  : fmt::format("{} of {}", c.metric, in_code(c.operations));
    const std::string place = words_of(c).place;
    const std::string says = c.criterion ? "; says " + file::markdown_text(c.criterion->text) : "";
    return fmt::format(
        "| {}{} | {}{} | {} | {} = {}{} | {} |\n", verdict, all.empty() ? "" : ": " + all,
        file::markdown_text(c.statement), c.note.empty() ? "" : " <br> *" + file::markdown_text(c.note) + "*",
        file::markdown_text(fmt::format("{}{}{}", c.tested(), " " + c.format, place.empty() ? "" : ", " + place)), what,
        number + bounds_text(r) + spread_text(r), says, file::markdown_code(c.id));
}

}  // namespace

void write_claim_report(const std::filesystem::path& folder, const std::vector<Claim>& claims,
                        const std::vector<ClaimResult>& results, const ClaimRequest& run) {
    file::AtomicFile readme(folder / "README.md");
    const CountsBySource counts = count_verdicts(claims, results);
    const std::size_t other = claims.size() - counts.all.confirmed();
    std::string text = fmt::format(
        "# What the sources say, and what we measure\n\nMade by `lostbits check{} --report reports`; do not edit. {} "
        "claims, each a sentence or a part of one{}: {}. A sentence is qualified that is true with a condition that "
        "its "
        "source does not state. The verdicts on {} follow from what the sentence says of the number (\"says = 0\"); "
        "the "
        "others describe a number. Every number was measured by the run "
        "that made this page; a test makes the page again and compares. `lostbits report` makes the same as a page for "
        "a browser, where each claim leads to its pixels or its plot.\n\nClaims about random rays were measured on "
        "several draws of them: all must lie in the claim's interval, which is the range over 32 draws, and half as "
        "much again on either side (in logarithms of onsets and fractions).\n{}",
        draws_option(results), claims.size(),
        other == 0 ? "" : fmt::format(", of which {} failed or could not be measured", other), counts.text(),
        counts.all.with_criterion, screenshots_in(folder));
    for (const ClaimSubject& subject : subjects_of(claims)) {
        text += fmt::format("\n## {}\n\n", file::markdown_text(subject.name));
        ShownSubject shown{folder, {}, run};
        for (const std::size_t i : subject.claims) shown.claims.push_back(&claims[i]);
        std::visit(
            [&](const auto& on) {
                if constexpr (requires { picture_of(on, shown); }) text += picture_of(on, shown) + "\n";
            },
            claims[subject.claims.front()].subject);
        text += samples_text(subject, results);
        std::string source;
        for (const std::size_t i : subject.claims) {
            if (claims[i].source != source) {
                source = claims[i].source;
                text += fmt::format(
                    "{}Source: {}\n\n| verdict | sentence | measured on | measured | claim |\n|---|---|---|---|---|\n",
                    i == subject.claims.front() ? "" : "\n", source == "-" ? "our own" : file::markdown_text(source));
            }
            text += row_text(claims[i], results[i]);
        }
    }
    readme.write(text);
    write_claims_csv(folder / "claims.csv", claims, results);
    readme.commit();
}

}  // namespace lostbits::output::claim
