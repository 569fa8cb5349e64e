// `lostbits map`: measures forms on every pixel of scenes, and writes pictures, tables and EXR files.
#include "measure/evaluate/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include "analysis/selection/external.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/shard/pieces.hpp"
#include "analysis/study/measurements.hpp"
#include "commands.hpp"
#include "intersect/conventions.hpp"
#include "measure/contract/suspect.hpp"
#include "measure/study/bands.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/map/map_exr.hpp"
#include "output/map/map_files.hpp"
#include "output/map/needed_files.hpp"
#include "scene/file/scene.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::analysis {

using measure::answer::Outcome;
using measure::evaluate::BitsNeededStudy;
using measure::evaluate::TestedForm;
using measure::metric::Metric;
using scene::file::Scene;

namespace {

struct MapOptions : selection::SharedOptions {
    std::string range, against, shard;
    std::vector<std::string> metrics;
    int bits_needed = 0;  ///< 0: not asked for
    bool envelope = false, exr = false;
};

/// Returns the options that change a scene, as text of a command line.
std::string scene_options_text(const MapOptions& options) {
    return concatenate(" --set '", options.scenes.set, "'") +
           (options.scenes.size.empty() ? "" : " --size " + options.scenes.size);
}

/// The command that makes the same EXR again, with exactly the options that decide its bytes.
std::string canonical_command(const Scene& scene, const MapOptions& options) {
    return fmt::format(
        "lostbits map {}{}{}{}{}{}{}{} --exr{}", scene.id, output::attribution::plugin_options(),
        concatenate(" -i '", options.forms, "'"), concatenate(" -f ", options.formats),
        concatenate(" --metric ", options.metrics) + (options.range.empty() ? "" : " --range " + options.range),
        options.envelope ? " --envelope" : "", options.against.empty() ? "" : " --against " + options.against,
        options.bits_needed > 0 ? fmt::format(" --bits {}", options.bits_needed) : "", scene_options_text(options));
}

/// The forms that exist in every width, as --bits requires. Throws NothingSelected if there are none.
std::vector<const intersect::table::Intersector*> forms_of_any_width(const std::vector<TestedForm>& tested_forms) {
    std::vector<const intersect::table::Intersector*> forms;
    for (const TestedForm& tested_form : tested_forms)
        if (tested_form.form->rounded != nullptr) selection::add_once(forms, tested_form.form);
    if (forms.empty())
        throw NothingSelected(
            "--bits: no selected form exists in formats of every width; `lostbits list forms` lists "
            "the formats of each form");
    return forms;
}

/// The work on one scene.
struct SceneWork {
    measure::evaluate::MapStudy map;
    std::optional<BitsNeededStudy> bits_needed;

    [[nodiscard]] std::uint64_t work_units() const {
        return map.scene->pixels() * map.rows.size() + (bits_needed ? bits_needed->units() : 0);
    }
};

SceneWork plan_scene(const Scene& scene, const MapOptions& options, const std::vector<TestedForm>& tested_forms,
                     const std::vector<const Metric*>& metrics, measure::metric::MetricSet& metric_set) {
    auto scene_forms = selection::filter_tested_forms(tested_forms, [&](Shapes forms) { return scene.accepts(forms); });
    SceneWork work{study::map_study(scene, std::move(scene_forms), metrics, metric_set, options.scenes.stop), {}};
    if (options.bits_needed > 0) {
        selection::refuse_generators(tested_forms, "--bits");
        work.bits_needed.emplace(BitsNeededStudy{.scene = scene,
                                                 .rows = forms_of_any_width(work.map.rows),
                                                 .bits = options.bits_needed,
                                                 .limit = work.map.limit});
    }
    return work;
}

/// Prints which forms `--bits` leaves out.
void note_forms_without_every_width(const std::vector<SceneWork>& scene_works) {
    std::set<std::string_view> noted_names;
    for (const SceneWork& work : scene_works) {
        for (const TestedForm& tested_form : work.map.rows) {
            const intersect::Info& info = *tested_form.form->info;
            if (tested_form.form->rounded != nullptr || !noted_names.insert(info.name).second) continue;
            fmt::print(stderr, "lostbits: --bits leaves out {}: it exists in {} only\n", info.name,
                       selection::formats_text(*tested_form.form));
        }
    }
}

/// The metrics that the EXR stores for every pixel beside the answer and its outcome: lost bits, the drawn metrics and,
/// for an envelope, excess bits. Metrics that the map of this scene does not measure are left out.
std::vector<const Metric*> exr_layers(const SceneWork& work, const MapOptions& options,
                                      std::vector<const Metric*> drawn_metrics) {
    std::vector<const Metric*> layers{measure::metric::find_metric("lost_bits")};
    if (options.envelope) drawn_metrics.push_back(measure::metric::find_metric("excess_bits"));
    for (const Metric* m : drawn_metrics) selection::add_once(layers, m);
    std::erase_if(
        layers, [&work](const Metric* m) { return std::ranges::find(work.map.metrics, m) == work.map.metrics.end(); });
    return layers;
}

/// The summaries of a scene at the end.
struct SceneSummaries {
    std::vector<measure::evaluate::FormSummary> map;
    std::vector<measure::evaluate::BitsNeededSummary> bits_needed;
};

/// Prints which forms missed hits because they return one crossing and the range of the rays excludes it.
void note_missed_crossings(const SceneWork& work, const std::vector<measure::evaluate::FormSummary>& summaries) {
    const Range<double>& range = work.map.scene->range;
    if (!range.open.tmin && !(range.tmin > 0)) return;
    std::string missing_forms;
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        const TestedForm& tested_form = work.map.rows[r];
        const std::uint64_t missed = summaries[r].count(Outcome::false_miss);
        if (missed == 0 || tested_form.form->is_set() ||
            intersect::yields_next_crossing(*tested_form.form->info, tested_form.form->shape))
            continue;
        missing_forms +=
            fmt::format("{}{} {} ({} of {})", missing_forms.empty() ? "" : ", ", tested_form.form->info->name,
                        tested_form.format.name, missed, scene::toml::count_with_noun(summaries[r].true_hits, "hit"));
    }
    if (missing_forms.empty()) return;
    fmt::print(
        stderr,
        "lostbits: scene {}: its rays begin {} t = {:g}. These forms return only one crossing, and miss the next "
        "one if the range excludes the first: {}. Forms with next_crossing = yes in `lostbits list forms` return "
        "both\n",
        work.map.scene->id, range.open.tmin ? "beyond" : "at", range.tmin, missing_forms);
}

void print_results(const SceneWork& work, const SceneSummaries& summaries, const std::filesystem::path& folder,
                   bool verbose) {
    fmt::print("{}: {}\n", work.map.scene->id, scene::toml::count_with_noun(work.map.scene->pixels(), "ray"));
    print_table(work.map, summaries.map);
    print_comparisons(work.map.rows, work.map.metrics, summaries.map);
    if (work.bits_needed) print_table(*work.bits_needed, summaries.bits_needed);
    if (verbose) print_stages(*work.map.stages);
    print_figures(folder / "contact.png");
    if (work.bits_needed) fmt::print("{}\n", (folder / "needed.csv").string());
    note_missed_crossings(work, summaries.map);
    const measure::evaluate::FormSummary& first = summaries.map.front();
    if (first.count(Outcome::agree_miss) + first.count(Outcome::false_hit) == work.map.scene->pixels())
        fmt::print(stderr,
                   "lostbits: scene {}: no ray of its camera meets a primitive, so every pixel is a miss; check its "
                   "eye, look_at and width or fov\n",
                   work.map.scene->id);
}

/// Options, progress and division of the run, for the work on one scene.
struct MapContext {
    const CommonOptions& common;
    output::file::Progress& progress;
    RunDivision& run_division;
    const SceneFolders::CompleteCallback& complete;
    std::string sheet_with_explanations;  ///< see `MapFilesOptions`
};

/// Maps one scene. Returns the number of its rays without a proved truth; 0 in a shard, since the whole run counts
/// them.
std::uint64_t map_scene(SceneWork& work, const MapOptions& options, const std::vector<const Metric*>& drawn_metrics,
                        const MapContext& context) {
    const CommonOptions& common = context.common;
    output::file::Progress& progress = context.progress;
    shard::Division& division = context.run_division.division;
    const Scene& scene = *work.map.scene;
    const std::string job = "map " + scene.id, needed_job = "needed " + scene.id;
    const auto folder = std::filesystem::path(options.out) / scene.id;
    const bool writes_pixels = options.pixels == "csv";
    std::optional<output::map::MapExr> exr_file;
    if (options.exr)
        exr_file.emplace(context.run_division.path_to_write(folder / (scene.id + ".exr")),
                         output::map::MapExrRequest{.map = work.map,
                                                    .layers = exr_layers(work, options, drawn_metrics),
                                                    .command = canonical_command(scene, options),
                                                    .needed = work.bits_needed ? &*work.bits_needed : nullptr});
    output::map::MapExr* const exr = exr_file ? &*exr_file : nullptr;
    std::optional<output::map::NeededFiles> needed_files;
    if (work.bits_needed)
        needed_files.emplace(
            *work.bits_needed,
            output::map::NeededFilesOptions{folder, writes_pixels, exr, shard::piece_recorder(division, needed_job)});
    output::map::MapFiles files(
        work.map, {.folder = folder,
                   .drawn_metrics = drawn_metrics,
                   .single_pictures = options.pictures == "all",
                   .pixels_csv = writes_pixels,
                   .scene_arguments = selection::name_of_scene(scene, selection::data_folder(common.data)) +
                                      scene_options_text(options),
                   .sheet_with_explanations = context.sheet_with_explanations,
                   .draws_envelope = options.envelope,
                   .exr = exr,
                   .other_tables = needed_files ? needed_files->resources() : std::vector<output::file::DataResource>{},
                   .range = selection::parse_range(options.range, drawn_metrics),
                   .keep_piece = shard::piece_recorder(division, job)});

    SceneSummaries summaries;
    auto map_summaries = shard::run_divided(work.map, files, division, job);
    if (map_summaries) summaries.map = std::move(*map_summaries);
    if (work.bits_needed) {
        // --bits tests the rays in many widths, so the time of the map does not predict its time.
        output::file::Estimate estimate(progress, scene.id + " --bits",
                                        work.bits_needed->units() / division.share().count, common.quiet);
        BitsNeededStudy study = *work.bits_needed;
        study.progress = advance_callback(progress, &estimate);
        if (auto needed_summaries = shard::run_divided(study, *needed_files, division, needed_job))
            summaries.bits_needed = std::move(*needed_summaries);
    }
    if (!map_summaries) return 0;
    if (work.bits_needed) needed_files->finish(summaries.bits_needed);
    files.finish(summaries.map);
    context.complete();
    if (!common.quiet) progress.print_without_bar([&] { print_results(work, summaries, folder, common.verbose); });
    return summaries.map.front().count(Outcome::unresolved);
}

/// Returns the metrics that the work on a scene measures, for the metrics of the same names in `drawn_metrics`.
std::vector<const Metric*> measured_metrics_of(std::vector<const Metric*> drawn_metrics, const SceneWork& work) {
    std::ranges::transform(drawn_metrics, drawn_metrics.begin(), [&work](const Metric* m) {
        return work.map.metrics[measure::metric::index_of(work.map.metrics, m->name)];
    });
    return drawn_metrics;
}

Exit run(MapOptions options, const CommonOptions& common) {
    require_folder(options.out);
    auto rows = selection::pair_forms_with_formats(selection::select_forms(options.forms),
                                                   selection::select_formats(options.formats));
    if (!options.against.empty()) selection::compare_against(rows, options.against, common.quiet);
    measure::metric::MetricSet metric_set;
    auto drawn_metrics = options.metrics.empty() ? std::vector{measure::metric::find_metric("lost_bits")}
                                                 : selection::select_metrics(options.metrics, metric_set);
    if (!options.against.empty()) selection::add_comparison_metrics(drawn_metrics);
    auto measured_metrics = drawn_metrics;
    if (options.envelope) {
        if (std::ranges::find(drawn_metrics, measure::metric::find_metric("lost_bits")) == drawn_metrics.end())
            throw InputError(
                "--envelope marks pictures of lost_bits, but --metric does not draw them; add --metric lost_bits");
        measured_metrics.push_back(measure::metric::find_metric("excess_bits"));
    }
    auto scenes = selection::load_scenes(options.scenes, selection::data_folder(common.data));
    const auto handling_forms = selection::drop_unhandled(
        scenes, {rows, options.forms, common.quiet}, [](const Scene& s, Shapes forms) { return s.accepts(forms); },
        [](const Scene& s) { return s.id; });
    selection::note_unmeasured(options.forms, handling_forms, common.quiet);
    // Called here and below only for their errors, which end the run before any work.
    static_cast<void>(selection::parse_range(options.range, drawn_metrics));
    const selection::ThreadLimit limit(common.threads);

    std::vector<SceneWork> scene_works;
    for (const auto& scene : scenes)
        scene_works.push_back(plan_scene(scene, options, rows, measured_metrics, metric_set));
    for (const SceneWork& work : scene_works)
        static_cast<void>(selection::applicable_metrics(drawn_metrics, work.map.rows, "scene " + work.map.scene->id));
    std::vector<std::filesystem::path> files;
    for (const auto& scene : scenes) files.push_back(scene.path);
    auto run_division = divide_run(options.shard, options.out, files, common);
    std::vector<std::string> jobs;
    for (const SceneWork& work : scene_works) {
        jobs.push_back("map " + work.map.scene->id);
        if (work.bits_needed) jobs.push_back("needed " + work.map.scene->id);
    }
    run_division.division.expect(jobs);
    options.out = run_division.out.string();
    SceneFolders folders(scenes, run_division, common);
    for (const SceneWork& work : scene_works)
        selection::note_forms_without_formula(drawn_metrics, work.map.rows, common.quiet);
    if (options.bits_needed > 0 && !common.quiet) note_forms_without_every_width(scene_works);
    for (const SceneWork& work : scene_works)
        selection::note_numbers(*work.map.scene, options.scenes.set, work.map.rows, common.quiet);

    std::uint64_t units = 0;
    for (const SceneWork& work : scene_works) units += work.work_units();
    output::file::Progress progress(units / run_division.division.share().count, "map", common.progress, common.quiet);
    const std::uint64_t unresolved =
        folders.for_each(scene_works.size(), progress, [&](std::size_t scene_index, const auto& complete) {
            SceneWork work = scene_works[scene_index];  // a copy that may point to objects of this iteration
            measure::truth::StageCounts stages;
            const auto bands = measure::study::Bands(*work.map.scene, run_division.division.share()).size();
            output::file::Estimate estimate(
                progress, work.map.scene->id,
                work.map.scene->pixels() * work.map.rows.size() / run_division.division.share().count, common.quiet,
                bands);
            work.map.progress = advance_callback(progress, &estimate);
            work.map.stages = &stages;
            return map_scene(work, options,
                             measured_metrics_of(
                                 selection::applicable_metrics(drawn_metrics, work.map.rows, work.map.scene->id), work),
                             {common, progress, run_division, complete,
                              scene_index == 0 ? "" : scene_works.front().map.scene->id + "/contact"});
        });
    if (!finish_run(run_division, common)) return Exit::done;
    for (const SceneWork& work : scene_works)
        note_suspicions(work.map.rows, common, [&work](const TestedForm& tested_form) {
            return measure::contract::suspicion_text(*work.map.scene, tested_form);
        });
    return report_unproved(unresolved);
}

}  // namespace

void add_map(const shell::Command& program, const CommonOptions& common) {
    auto command =
        program.add_command("map", "Draw the error of every selected form and format over the pixels of a scene");
    const auto options = std::make_shared<MapOptions>();
    options->forms = {"*"};
    options->formats = {"f32", "f64"};
    options->scenes.stop = common.stop;
    selection::add_scenes(command, *options);
    selection::add_forms(command, options->forms);
    selection::add_formats(command, options->formats, "f32 f64");
    command.add_list("--metric", options->metrics,
                     "Metrics to draw, by name or glob (default: lost_bits); see `lostbits list metrics`");
    command.add("--range", options->range,
                "Ends of the colour bar, LO:HI in the unit of the metric (default: all bits of each format)");
    selection::add_changes(command, options->scenes, "sphere[0].radius=10");
    selection::add_pixels(command, *options);
    selection::add_pictures(command, options->pictures);
    command.add(
        "--bits", options->bits_needed,
        "Also draw, for every pixel, the narrowest significand with which the form keeps this many correct bits",
        shell::whole_number_between(1, 52));
    command.add("--exr", options->exr,
                "Also write SCENE.exr, with the answers, outcomes and metrics of every pixel (docs/files.md)");
    command.add("--against", options->against,
                "Also compare every form with this form: draw and count the rays on which the answers differ");
    command.add(
        "--envelope", options->envelope,
        "In pictures of lost_bits, draw a pixel paler if inputs that are off by half an ulp could explain the loss; "
        "the problem is then to blame, not the formula");
    add_shard(command, options->shard);
    selection::add_out(command, options->out);
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
