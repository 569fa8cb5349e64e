#include "analysis/report/report_sections.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>

#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/study/measurements.hpp"
#include "analysis/study/studies_by_name.hpp"
#include "measure/evaluate/culprit_order.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/sweep/sweep.hpp"
#include "output/image/figure.hpp"
#include "output/map/finding.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_colour.hpp"
#include "output/map/map_files.hpp"
#include "output/report/page.hpp"
#include "output/report/sweep_data.hpp"
#include "output/sweep/case_files.hpp"
#include "output/sweep/sweep_plots.hpp"
#include "output/trade/trade_files.hpp"
#include "scene/sweep/case_file.hpp"

namespace lostbits::analysis::report {

using measure::evaluate::TestedForm;
using output::report::SweepSection;

namespace {

std::vector<std::string> names_of_tested_forms(const std::vector<TestedForm>& tested_forms) {
    std::vector<std::string> keys;
    for (const TestedForm& tested_form : tested_forms) keys.push_back(output::map::tested_form_name(tested_form));
    return keys;
}

/// The metrics that the section of a sweep or of cases shows.
std::vector<const measure::metric::Metric*> section_metrics(const PlannedSweep& planned) {
    return selection::with_default_metrics(
        {measure::metric::find_metric("inherent_bits"), measure::metric::find_metric("excess_bits")},
        planned.tested_forms);
}

/// A section with the texts of a file of cases or of a sweep, and without results.
template <class File>
SweepSection begin_section(SweepSection::Kind kind, const File& file, const PlannedSweep& planned) {
    return {.kind = kind,
            .id = file.id,
            .title = file.title,
            .note = file.note,
            .source = file.source,
            .tested_form_names = names_of_tested_forms(planned.tested_forms)};
}

SweepSection measure_case_section(const PlannedSweep& planned, StopToken stop) {
    const scene::sweep::CaseFile file(planned.path);
    measure::sweep::CaseRequest request{.file = file,
                                        .tested_forms = study::with_each_convention(file, planned.tested_forms),
                                        .metrics = section_metrics(planned),
                                        .limit = {.stop = stop}};
    const auto cases = measure::sweep::run_cases(request);

    SweepSection section = begin_section(SweepSection::Kind::cases, file, planned);
    for (std::size_t i = 0; i < file.size(); ++i) section.cases.push_back(file.name(i));
    section.json = output::report::case_json(request, cases);

    // One chart for each convention.
    for (const auto& touching : file.conventions) {
        const std::string alt =
            touching ? fmt::format("{}, judged by the {} primitive", file.title, intersect::convention_name(touching))
                     : file.title;
        section.charts.push_back({alt, svg_text(output::sweep::draw_case_matrix(request, cases, touching)),
                                  std::string(intersect::convention_name(touching)), false});
    }
    return section;
}

/// Charts of the sweep for each format, named by a statistic of `output::report::sweep_statistics` and the format.
std::vector<output::report::Chart> line_charts(const output::sweep::MeasuredSweep& sweep) {
    constexpr output::sweep::PlotSize size{900, 480};
    std::vector<output::report::Chart> charts;
    for (const Format& format : output::sweep::list_formats(sweep)) {
        const std::string subject = fmt::format("{}, {}", sweep.request.sweep.title, format.name);
        for (const auto& [q, title, name] : {std::tuple(0.99, "99th percentile of lost bits: ", "lost_bits_p99"),
                                             {0.5, "Median of lost bits: ", "lost_bits_p50"}})
            charts.push_back({title + subject, svg_text(draw_lost_bits_plot(sweep, format, q, size)),
                              fmt::format("{}.{}", name, format.name)});
        for (const auto outcome : output::sweep::wrong_outcomes(sweep, format)) {
            if (!output::sweep::has_outcome(sweep, format, outcome)) continue;
            charts.push_back(
                {output::sweep::outcome_title(outcome) + ": " + subject,
                 svg_text(draw_outcome_plot(sweep, format, outcome, size)),
                 fmt::format("{}_fraction.{}", measure::answer::outcome_names[static_cast<std::size_t>(outcome)],
                             format.name)});
        }
    }
    return charts;
}

/// Names the charts that are left out because they would show only zeros: `In f64, no ray is a false hit.` Empty if
/// every chart has other values.
std::string absent_charts(const output::sweep::MeasuredSweep& sweep, const Format& format) {
    std::string names;
    for (const auto outcome : output::sweep::wrong_outcomes(sweep, format))
        if (!output::sweep::has_outcome(sweep, format, outcome))
            names += (names.empty() ? "a " : " or a ") + output::map::outcome_in_words(outcome);
    return names.empty() ? "" : fmt::format("In {}, no ray is {}.", format.name, names);
}

/// Makes the section of a sweep over a plane: one chart for each form and format.
void add_plane(SweepSection& section, const measure::sweep::SweepRequest& request,
               const std::vector<measure::sweep::SweepStep>& steps) {
    const output::sweep::SweepGrid plane(request, steps);
    section.kind = SweepSection::Kind::plane;
    section.axes = {plane.x, plane.y};
    section.json = output::report::plane_json(request, steps);
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        const std::string alt =
            fmt::format("{}: {} in {}", request.sweep.title, request.tested_forms[r].form->info->name,
                        request.tested_forms[r].format.name);
        section.charts.push_back(
            {alt, svg_text(output::sweep::draw_plane_picture(request, steps, r)), section.tested_form_names[r], false});
    }
}

/// Makes the section of a sweep along one axis: its onsets, and charts for each format.
void add_line(SweepSection& section, const measure::sweep::SweepRequest& request,
              const std::vector<measure::sweep::SweepStep>& steps) {
    const auto onsets = measure::sweep::find_onsets(request, steps);
    section.axes = {request.sweep.axes.front().values};
    section.json = output::report::sweep_json(request, steps, onsets);
    section.table = output::report::onset_table(request, onsets);

    const output::sweep::MeasuredSweep measured{request, steps, onsets};
    section.charts = line_charts(measured);
    for (const Format& format : output::sweep::list_formats(measured)) {
        const std::string absent = absent_charts(measured, format);
        section.json["absent"][format.name] = absent;
        if (!absent.empty()) section.table += fmt::format("<p>{}</p>\n", absent);
    }
}

SweepSection measure_axes_section(const PlannedSweep& planned, StopToken stop) {
    const scene::sweep::SweepFile sweep(planned.path, planned.data, {}, stop);
    measure::sweep::SweepRequest request{.sweep = sweep,
                                         .tested_forms = planned.tested_forms,
                                         .metrics = section_metrics(planned),
                                         .limit = {.stop = stop}};
    for (TestedForm& tested_form : request.tested_forms) tested_form.touching = sweep.convention;
    const auto steps = measure::sweep::run_sweep(request);

    SweepSection section = begin_section(SweepSection::Kind::line, sweep, planned);
    if (sweep.axes.size() == 2) {
        add_plane(section, request, steps);
    } else {
        request.further_draw_count = planned.further_draw_count;
        add_line(section, request, steps);
    }
    return section;
}

}  // namespace

output::report::MapSection measure_map_section(PlannedMap& planned, measure::metric::MetricSet& metric_set,
                                               const std::function<void(std::uint64_t)>& advance, StopToken stop) {
    const scene::file::Scene& scene = planned.scene;
    measure::evaluate::MapStudy request{
        .scene = &scene, .tested_forms = planned.tested_forms, .metrics = planned.metrics, .limit = {.stop = stop}};
    request.metrics = measure::evaluate::order_culprits(request, metric_set);
    request.progress = advance;

    // Measures the map. The sheet and the data of the page get the same bands.
    output::report::MapData data(request);
    std::vector<measure::evaluate::FormSummary> summaries;
    output::report::Picture contact_sheet = output::report::picture(
        fmt::format("{}: lost bits of every form and format", scene.title), [&](const auto& file) {
            output::map::MapWriter sheet(request, {.folder = {},
                                                   .drawn_metrics = {measure::metric::find_metric("lost_bits")},
                                                   .scene_arguments = planned.scene_arguments,
                                                   .sheet_only_file = file});
            summaries = measure::evaluate::run_map(request, [draw = sheet.show(), collect = data.band_receiver()](
                                                                std::size_t form_index, const auto& band) {
                draw(form_index, band);
                collect(form_index, band);
            });
            sheet.finish(summaries);
        });
    planned.unresolved = summaries.front().count(measure::answer::Outcome::unresolved);

    auto index = data.index(summaries, planned.has_own_size, planned.scene_arguments);
    index["claimed"] = planned.name_in_claims;
    std::vector<std::string> names;
    for (const measure::metric::Metric* m : planned.metrics) names.emplace_back(m->name);
    return {.id = scene.id,
            .title = scene.title,
            .note = scene.note,
            .source = scene.source,
            .tested_form_names = names_of_tested_forms(planned.tested_forms),
            .index = std::move(index),
            .named_data = data.named_data(summaries),
            .table = output::report::summary_table(request, summaries),
            .sheet = std::move(contact_sheet),
            .has_scene_size = planned.has_own_size,
            .metrics = std::move(names),
            .finding = output::map::finding_text(request, summaries),
            .wrong_row_count = static_cast<std::size_t>(
                std::ranges::count_if(summaries, [](const auto& s) { return s.wrong_count() > 0; }))};
}

SweepSection measure_sweep_section(const PlannedSweep& planned, StopToken stop) {
    SweepSection section = scene::sweep::read_sweep_kind(planned.path) == scene::sweep::SweepKind::cases
                               ? measure_case_section(planned, stop)
                               : measure_axes_section(planned, stop);
    section.json["named"] = selection::sweep_argument(planned.path, planned.data);
    section.json["claimed"] = selection::sweep_name_in_claims(planned.path, planned.data);
    return section;
}

std::vector<scene::file::Scene> load_offset_scenes(const std::vector<std::string>& names, const std::string& size,
                                                   const std::filesystem::path& data, StopToken stop) {
    auto scenes = selection::load_scenes({names, size, "", {}, stop}, data);
    for (const auto& scene : scenes) {
        measure::offset::require_few_primitives(scene);
    }
    return scenes;
}

PlannedStudy parse_study(const std::string& text, const std::string& size, const std::filesystem::path& data,
                         StopToken stop) {
    const std::size_t colon = text.find(':');
    const std::string names = fmt::format("{}", fmt::join(study::study_names(), ", "));
    if (colon == std::string::npos)
        throw InputError(
            fmt::format("--study {}: the scene is missing; write STUDY:SCENE, where STUDY is one of {}", text, names));
    static_cast<void>(study::StudiesByName().allowed_names(text.substr(0, colon)));  // throws for an unknown study
    auto scenes = selection::load_scenes({{text.substr(colon + 1)}, size, "", {}, stop}, data);
    if (scenes.size() != 1)
        throw InputError(fmt::format("--study {}: the scene has variants; name one, such as {}:{}", text,
                                     text.substr(0, colon), scenes.front().id));
    return {text.substr(0, colon), std::move(scenes.front())};
}

output::report::StudySection measure_study_section(const PlannedStudy& planned, const std::vector<std::string>& forms,
                                                   const std::vector<std::string>& formats, StopToken stop) {
    auto section = study::measure_study_section(planned.study, planned.scene, forms, formats, stop);
    if (!section)
        throw NothingSelected(
            fmt::format("--study {0}:{1}: none of the forms fits; `lostbits {0} --help` says which "
                        "forms and scenes the study takes",
                        planned.study, planned.scene.id));
    return std::move(*section);
}

output::report::TradeSection measure_trade_section(Shape shape, const std::vector<TestedForm>& tested_forms,
                                                   StopToken stop) {
    std::vector<TestedForm> timed = tested_forms;
    measure::trade::TradeRequest request =
        study::trade_request(nullptr, std::string(name_of(shape)), {timed, {}, true});
    request.plan = study::quick_plan();
    request.limit.stop = request.plan.stop = stop;
    const measure::trade::TradeResult result = measure::trade::run_trade(request);
    output::report::TradeSection section{std::string(shape_names[static_cast<std::size_t>(shape)]),
                                         output::report::trade_json(request, result),
                                         output::trade::trade_text(request, result),
                                         {}};
    const auto sets = measure::trade::ray_sets(shape);
    for (std::size_t s = 0; s < sets.size(); ++s)
        section.charts.push_back({fmt::format("Time against kept bits: {}", sets[s].title),
                                  svg_text(draw_scatter_plot(output::trade::make_trade_plot(request, result, s))),
                                  std::string(sets[s].name)});
    return section;
}

}  // namespace lostbits::analysis::report
