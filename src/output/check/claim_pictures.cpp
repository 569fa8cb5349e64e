// Pictures of the subjects of claims, as Markdown and image files.
#include "output/check/claim_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "measure/check/claim_columns.hpp"
#include "measure/check/claim_studies.hpp"
#include "measure/evaluate/map.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/file/escape.hpp"
#include "output/image/figure.hpp"
#include "output/map/map_files.hpp"
#include "output/sweep/case_files.hpp"
#include "output/sweep/sweep_plots.hpp"

namespace lostbits::output::check {

using intersect::Touching;
using measure::evaluate::TestedForm;
using scene::check::SceneSubject;
using scene::check::StudySubject;

namespace {

/// Loads the scene that claims are about. If `name` names no variant, loads the first one.
scene::file::Scene load_scene_of_claims(const std::string& name, const ClaimRequest& request) {
    const auto found = scene::file::find_scene(name, request.data_dir);
    return std::move(scene::file::load_scene(found.path, {.variant = found.variant, .stop = request.stop}).front());
}

/// The forms and formats that the claims name. Each is listed once, in the order of the catalogue.
std::vector<TestedForm> claimed_forms(const std::vector<const Claim*>& claims) {
    std::vector<TestedForm> tested_forms;
    for (const Claim* const claim : claims) {
        const TestedForm tested_form = measure::check::tested_form_of(*claim);
        const auto is_same_series = [&](const TestedForm& r) {
            return r.form == tested_form.form && r.format == tested_form.format && r.touching == tested_form.touching;
        };
        if (std::ranges::none_of(tested_forms, is_same_series)) tested_forms.push_back(tested_form);
    }
    std::ranges::stable_sort(
        tested_forms, {}, [catalogue = intersect::table::catalogue()](const TestedForm& tested_form) {
            const auto entry =
                std::ranges::find(catalogue, tested_form.form->info, &intersect::table::Intersector::info);
            return std::pair(entry - catalogue.begin(),
                             tested_form.form->info->name);  // forms made at run time come last, by name
        });
    return tested_forms;
}

std::vector<const Metric*> drawn_metrics() {
    std::vector<const Metric*> metrics;
    for (const char* name : {"lost_bits", "ulp_error", "inherent_bits", "excess_bits"})
        metrics.push_back(measure::metric::find_metric(name));
    return metrics;
}

std::filesystem::path picture_path(const ShownSubject& shown, const std::string& file) {
    return shown.folder / "pictures" / file;
}

std::string picture_link(const ShownSubject& shown, const std::string& title, const std::string& file) {
    const std::string name = image::figure_paths(picture_path(shown, file)).front().filename().string();
    return fmt::format("![{}](pictures/{})\n", file::markdown_text(title), file::markdown_path(name));
}

/// Markdown that shows a scene. If all claims are about samples of a march, it lists the samples of the march through
/// the first pixel. Otherwise it shows the picture of the scene.
std::string draw_picture(const SceneSubject& subject, const ShownSubject& shown) {
    const std::vector<TestedForm> tested_forms = claimed_forms(shown.claims);
    const scene::file::Scene scene = load_scene_of_claims(subject.name, shown.request);
    const auto is_about_march = [](const Claim* claim) {
        return claim->subject_if<SceneSubject>() && claim->subject_if<SceneSubject>()->step;
    };

    if (std::ranges::all_of(shown.claims, is_about_march)) {
        const measure::answer::OneRay ray(scene, 0, 0, {.stop = shown.request.stop});
        std::string text;
        for (const TestedForm& tested_form : tested_forms)
            text += fmt::format("```\n{}```\n", attribution::march_table(*tested_form.form, tested_form.format, ray));
        return text;
    }

    const measure::evaluate::MapStudy request{.scene = &scene,
                                              .tested_forms = tested_forms,
                                              .metrics = {measure::metric::find_metric("lost_bits")},
                                              .limit = {.stop = shown.request.stop}};
    const std::string file = scene.id + ".png";
    map::MapWriter sheet(request, {.folder = {},
                                   .drawn_metrics = request.metrics,
                                   .scene_arguments = scene.id,
                                   .sheet_only_file = picture_path(shown, file)});
    sheet.finish(measure::evaluate::run_map(request, sheet.show()));
    return picture_link(shown, scene.title, file);
}

/// Markdown that shows the sheet of a study, with the forms, formats and options that its claims name.
std::string draw_picture(const StudySubject& subject, const ShownSubject& shown) {
    const scene::file::Scene scene = load_scene_of_claims(subject.name, shown.request);
    measure::check::StudyQuestion question{
        .scene = scene, .tested_forms = claimed_forms(shown.claims), .stop = shown.request.stop};
    for (const Claim* const claim : shown.claims) {
        for (const auto& [option, value] : claim->subject_if<StudySubject>()->options) {
            auto& values = question.options[option];
            if (std::ranges::find(values, value) == values.end()) values.push_back(value);
        }
    }
    const std::string file = fmt::format("{}.{}.png", scene.id, subject.study);
    shown.request.studies->draw(subject.study, question, picture_path(shown, file));
    return picture_link(shown, scene.title, file);
}

/// Plots of a sweep that show the quantities of its claims.
struct SweepPlots {
    bool has_median = false;           ///< medians of lost bits
    bool has_tail = false;             ///< 99th percentiles of lost bits
    bool has_wrong_decisions = false;  ///< wrong decisions
};

SweepPlots needed_plots(const std::vector<const Claim*>& claims) {
    SweepPlots plots;
    for (const Claim* const claim : claims) {
        const std::string& quantity_name = claim->onset.empty() ? claim->metric : claim->onset;
        const std::string& statistic = claim->onset.empty() ? claim->metric : claim->statistic;
        // Bits of an operation are drawn as lost bits too.
        const bool is_bits =
            quantity_name.find("bits") != std::string::npos || measure::check::asks_for_attribution(*claim);
        plots.has_wrong_decisions |= !is_bits;
        const bool is_tail = statistic.ends_with("p99") || statistic.ends_with("max");
        plots.has_median |= is_bits && !is_tail;
        plots.has_tail |= is_bits && is_tail;
    }
    return plots;
}

/// Draws the matrix of a list of cases, once for each convention of the forms.
std::string draw_cases(const scene::sweep::CaseFile& file, const ShownSubject& shown) {
    const std::vector<TestedForm> tested_forms = claimed_forms(shown.claims);
    const measure::sweep::CaseRequest request{
        .file = file, .tested_forms = tested_forms, .metrics = drawn_metrics(), .limit = {.stop = shown.request.stop}};
    const auto cases = measure::sweep::run_cases(request);

    std::string text;
    for (const std::optional<Touching> touching :
         {std::optional<Touching>{}, std::optional{Touching::hit}, std::optional{Touching::miss}}) {
        if (std::ranges::none_of(tested_forms,
                                 [&](const TestedForm& tested_form) { return tested_form.touching == touching; }))
            continue;
        const std::string picture =
            touching ? fmt::format("{}.{}.png", file.id, intersect::convention_name(touching)) : file.id + ".png";
        image::save_figure(picture_path(shown, picture), sweep::draw_case_matrix(request, cases, touching));
        text += picture_link(shown, file.title, picture);
    }
    return text;
}

/// Draws a sweep with two axes as a picture for each form and format.
std::string draw_planes(const measure::sweep::SweepRequest& request,
                        const std::vector<measure::sweep::SweepStep>& steps, const ShownSubject& shown) {
    std::string text;
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        const std::string_view form = request.tested_forms[r].form->info->name;
        const std::string& format = request.tested_forms[r].format.name;
        const std::string file = fmt::format("{}.{}.{}.png", request.sweep.id, form, format);
        image::save_figure(picture_path(shown, file), sweep::draw_plane_picture(request, steps, r));
        text += picture_link(shown, fmt::format("{} in {}", form, format), file);
    }
    return text;
}

/// Draws the plots of a sweep with one axis that show the quantities of its claims, for each format.
std::string draw_plots(const sweep::MeasuredSweep& measured, const ShownSubject& shown) {
    const scene::sweep::SweepFile& sweep = measured.request.sweep;
    const SweepPlots plots = needed_plots(shown.claims);
    std::string text;
    for (const Format& format : sweep::list_formats(measured)) {
        const auto add_plot = [&](std::string_view name, const image::Canvas& plot) {
            const std::string file = fmt::format("{}.{}.{}.png", sweep.id, name, format.name);
            text += picture_link(shown, fmt::format("{}: {}, {}", sweep.title, name, format.name), file);
            image::save_figure(picture_path(shown, file), plot);
        };

        if (plots.has_median) add_plot("lost_bits_p50", sweep::draw_lost_bits_plot(measured, format, 0.5));
        if (plots.has_tail) add_plot("lost_bits_p99", sweep::draw_lost_bits_plot(measured, format, 0.99));
        if (!plots.has_wrong_decisions) continue;
        for (const measure::answer::Outcome outcome : sweep::wrong_outcomes(measured, format))
            add_plot(measure::answer::outcome_names[static_cast<std::size_t>(outcome)],
                     sweep::draw_outcome_plot(measured, format, outcome));
    }
    return text;
}

/// Markdown that shows the pictures of a sweep.
std::string draw_picture(const scene::check::SweepSubject& subject, const ShownSubject& shown) {
    const auto path = scene::sweep::find_sweep(subject.name, shown.request.data_dir);
    // The claims are about small ranges, but a picture would need the whole axis.
    if (scene::sweep::read_sweep_kind(path) == scene::sweep::SweepKind::every_float) return "";
    if (scene::sweep::read_sweep_kind(path) == scene::sweep::SweepKind::cases)
        return draw_cases(scene::sweep::CaseFile(path), shown);

    const scene::sweep::SweepFile sweep(path, shown.request.data_dir, {}, shown.request.stop);
    measure::sweep::SweepRequest request{.sweep = sweep,
                                         .tested_forms = claimed_forms(shown.claims),
                                         .metrics = drawn_metrics(),
                                         .limit = {.stop = shown.request.stop}};
    for (TestedForm& tested_form : request.tested_forms)
        tested_form.touching = tested_form.touching ? tested_form.touching : sweep.convention;

    const auto steps = measure::sweep::run_sweep(request);
    if (sweep.axes.size() == 2) return draw_planes(request, steps, shown);
    const auto onsets = measure::sweep::find_onsets(request, steps);
    return draw_plots({request, steps, onsets}, shown);
}

}  // namespace

std::string draw_subject_pictures(const ShownSubject& shown) {
    return std::visit(
        [&shown](const auto& subject) {
            if constexpr (requires { draw_picture(subject, shown); }) return draw_picture(subject, shown) + "\n";
            else return std::string();
        },
        shown.claims.front()->subject);
}

}  // namespace lostbits::output::check
