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
#include "output/map/bits_needed_files.hpp"
#include "output/map/map_exr.hpp"
#include "output/map/map_files.hpp"
#include "scene/file/scene.hpp"
#include "text/count_with_noun.hpp"

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

/// The forms that exist in every width, as --bits requires. Throws NothingSelected if no form exists in all of them.
std::vector<const intersect::table::Intersector*> forms_of_any_width(const std::vector<TestedForm>& tested_forms) {
    std::vector<const intersect::table::Intersector*> forms;
    for (const TestedForm& tested_form : tested_forms)
        if (tested_form.form->rounded != nullptr) selection::append_if_missing(forms, tested_form.form);
    if (forms.empty())
        throw NothingSelected(
            "--bits: no selected form exists in formats of every width; `lostbits list forms` lists "
            "the formats of each form");
    return forms;
}

/// A scene with the work on it.
struct PlannedScene {
    measure::evaluate::MapStudy map;
    std::optional<BitsNeededStudy> bits_needed;

    [[nodiscard]] std::uint64_t work_units() const {
        return map.scene->pixel_count() * map.tested_forms.size() + (bits_needed ? bits_needed->units() : 0);
    }
};

PlannedScene plan_scene(const Scene& scene, const MapOptions& options, const std::vector<TestedForm>& tested_forms,
                        const std::vector<const Metric*>& metrics, measure::metric::MetricSet& metric_set) {
    auto scene_forms = selection::filter_tested_forms(tested_forms, [&](Shapes forms) { return scene.accepts(forms); });
    PlannedScene planned{study::map_study(scene, std::move(scene_forms), metrics, metric_set, options.scenes.stop), {}};
    if (options.bits_needed > 0) {
        selection::require_no_generators(tested_forms, "--bits");
        planned.bits_needed.emplace(BitsNeededStudy{.scene = scene,
                                                    .tested_forms = forms_of_any_width(planned.map.tested_forms),
                                                    .correct_bits = options.bits_needed,
                                                    .limit = planned.map.limit});
    }
    return planned;
}

/// Prints which forms `--bits` leaves out.
void note_forms_without_every_width(const std::vector<PlannedScene>& planned_scenes) {
    std::set<std::string_view> noted_names;
    for (const PlannedScene& planned : planned_scenes) {
        for (const TestedForm& tested_form : planned.map.tested_forms) {
            const intersect::Info& info = *tested_form.form->info;
            if (tested_form.form->rounded != nullptr || !noted_names.insert(info.name).second) continue;
            fmt::print(stderr, "lostbits: --bits leaves out {}: it exists in {} only\n", info.name,
                       selection::formats_text(*tested_form.form));
        }
    }
}

/// The metrics that the EXR stores for every pixel beside the answer and its outcome: lost bits, the drawn metrics and,
/// for an envelope, excess bits. Metrics that the map of this scene does not measure are left out.
std::vector<const Metric*> exr_layers(const PlannedScene& planned, const MapOptions& options,
                                      std::vector<const Metric*> drawn_metrics) {
    std::vector<const Metric*> layers{measure::metric::find_metric("lost_bits")};
    if (options.envelope) drawn_metrics.push_back(measure::metric::find_metric("excess_bits"));
    for (const Metric* m : drawn_metrics) selection::append_if_missing(layers, m);
    std::erase_if(layers, [&planned](const Metric* m) {
        return std::ranges::find(planned.map.metrics, m) == planned.map.metrics.end();
    });
    return layers;
}

/// The summaries of a scene at the end.
struct SceneSummaries {
    std::vector<measure::evaluate::FormSummary> map;
    std::vector<measure::evaluate::BitsNeededSummary> bits_needed;
};

/// Prints which forms missed hits because they return one crossing and the range of the rays excludes it.
void note_missed_crossings(const PlannedScene& planned, const std::vector<measure::evaluate::FormSummary>& summaries) {
    const Range<double>& range = planned.map.scene->range;
    if (!range.open_ends.tmin && !(range.tmin > 0)) return;

    std::string missing_forms;
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        const TestedForm& tested_form = planned.map.tested_forms[r];
        const std::uint64_t missed = summaries[r].count(Outcome::false_miss);
        if (missed == 0 || tested_form.form->is_set() ||
            intersect::yields_next_crossing(*tested_form.form->info, tested_form.form->shape))
            continue;
        missing_forms +=
            fmt::format("{}{} {} ({} of {})", missing_forms.empty() ? "" : ", ", tested_form.form->info->name,
                        tested_form.format.name, missed, text::count_with_noun(summaries[r].true_hit_count, "hit"));
    }
    if (missing_forms.empty()) return;
    fmt::print(
        stderr,
        "lostbits: scene {}: its rays begin {} t = {:g}. These forms return only one crossing, and miss the next "
        "one if the range excludes the first: {}. Forms with next_crossing = yes in `lostbits list forms` return "
        "both\n",
        planned.map.scene->id, range.open_ends.tmin ? "beyond" : "at", range.tmin, missing_forms);
}

void print_results(const PlannedScene& planned, const SceneSummaries& summaries, const std::filesystem::path& folder,
                   bool verbose) {
    const Scene& scene = *planned.map.scene;
    fmt::print("{}: {}\n", scene.id, text::count_with_noun(scene.pixel_count(), "ray"));
    print_table(planned.map, summaries.map);
    print_comparisons(planned.map.tested_forms, planned.map.metrics, summaries.map);
    if (planned.bits_needed) print_table(*planned.bits_needed, summaries.bits_needed);
    if (verbose) print_stages(*planned.map.stages);
    print_figure_paths(folder / "contact.png");
    if (planned.bits_needed) fmt::print("{}\n", (folder / "needed.csv").string());

    note_missed_crossings(planned, summaries.map);
    const measure::evaluate::FormSummary& first = summaries.map.front();
    if (first.count(Outcome::agree_miss) + first.count(Outcome::false_hit) == scene.pixel_count())
        fmt::print(stderr,
                   "lostbits: scene {}: no ray of its camera meets a primitive, so every pixel is a miss; check its "
                   "eye, look_at and width or fov\n",
                   scene.id);
}

/// Options, progress and division of the run, for the work on one scene.
struct MapRun {
    const CommonOptions& common;
    output::file::Progress& progress;
    RunDivision& run_division;
    const SceneFolders::CompleteCallback& complete;
    std::string sheet_with_explanations;  ///< see `MapFilesOptions`
};

std::string map_job(const Scene& scene) { return "map " + scene.id; }
std::string bits_needed_job(const Scene& scene) { return "needed " + scene.id; }

/// Measures the narrowest significands of a scene, if --bits asks for them. Nothing without --bits, and in a shard.
std::vector<measure::evaluate::BitsNeededSummary> measure_bits_needed(
    const PlannedScene& planned, std::optional<output::map::BitsNeededWriter>& bits_needed_files,
    const MapRun& map_run) {
    if (!planned.bits_needed) return {};
    const Scene& scene = *planned.map.scene;
    shard::Division& division = map_run.run_division.division;
    // --bits tests the rays in many widths, so the time of the map does not predict its time.
    output::file::Estimate estimate(map_run.progress, scene.id + " --bits",
                                    planned.bits_needed->units() / division.share().count, map_run.common.quiet);
    BitsNeededStudy study = *planned.bits_needed;
    study.progress = advance_callback(map_run.progress, &estimate);
    auto summaries = shard::run_divided(study, *bits_needed_files, division, bits_needed_job(scene));
    return summaries ? std::move(*summaries) : std::vector<measure::evaluate::BitsNeededSummary>{};
}

/// Maps one scene. Returns the number of its rays without a proved truth; 0 in a shard, since the whole run counts
/// them.
std::uint64_t map_scene(PlannedScene& planned, const MapOptions& options,
                        const std::vector<const Metric*>& drawn_metrics, const MapRun& map_run) {
    const CommonOptions& common = map_run.common;
    shard::Division& division = map_run.run_division.division;
    const Scene& scene = *planned.map.scene;
    const auto folder = std::filesystem::path(options.out) / scene.id;
    const bool writes_pixels = options.pixels == "csv";

    // Opens the files. The EXR holds the results of the map and of --bits.
    std::optional<output::map::MapExr> exr_file;
    if (options.exr)
        exr_file.emplace(map_run.run_division.path_to_write(folder / (scene.id + ".exr")),
                         output::map::MapExrRequest{.map = planned.map,
                                                    .layers = exr_layers(planned, options, drawn_metrics),
                                                    .command = canonical_command(scene, options),
                                                    .needed = planned.bits_needed ? &*planned.bits_needed : nullptr});
    output::map::MapExr* const exr = exr_file ? &*exr_file : nullptr;
    std::optional<output::map::BitsNeededWriter> bits_needed_files;
    if (planned.bits_needed)
        bits_needed_files.emplace(*planned.bits_needed, output::map::BitsNeededFilesOptions{
                                                            folder, writes_pixels, exr,
                                                            shard::piece_recorder(division, bits_needed_job(scene))});
    output::map::MapWriter files(
        planned.map,
        {.folder = folder,
         .drawn_metrics = drawn_metrics,
         .draws_single_pictures = options.pictures == "all",
         .writes_pixels_csv = writes_pixels,
         .scene_arguments =
             selection::scene_arguments(scene, selection::data_folder(common.data)) + scene_options_text(options),
         .sheet_with_explanations = map_run.sheet_with_explanations,
         .draws_envelope = options.envelope,
         .exr = exr,
         .other_tables = bits_needed_files ? bits_needed_files->resources() : std::vector<output::file::DataResource>{},
         .range = selection::parse_range(options.range, drawn_metrics),
         .keep_piece = shard::piece_recorder(division, map_job(scene))});

    // A shard measures and records, but has no summaries.
    auto map_summaries = shard::run_divided(planned.map, files, division, map_job(scene));
    const auto bits_needed_summaries = measure_bits_needed(planned, bits_needed_files, map_run);
    if (!map_summaries) return 0;

    const SceneSummaries summaries{std::move(*map_summaries), bits_needed_summaries};
    if (planned.bits_needed) bits_needed_files->finish(summaries.bits_needed);
    files.finish(summaries.map);
    map_run.complete();
    if (!common.quiet)
        map_run.progress.print_without_bar([&] { print_results(planned, summaries, folder, common.verbose); });
    return summaries.map.front().count(Outcome::unresolved);
}

/// Returns the metrics that the work on a scene measures, for the metrics of the same names in `drawn_metrics`.
std::vector<const Metric*> find_measured_metrics(std::vector<const Metric*> drawn_metrics,
                                                 const PlannedScene& planned) {
    std::ranges::transform(drawn_metrics, drawn_metrics.begin(), [&planned](const Metric* m) {
        return planned.map.metrics[measure::metric::index_of(planned.map.metrics, m->name)];
    });
    return drawn_metrics;
}

/// The metrics of --metric, and the others that the options need.
struct MapMetrics {
    std::vector<const Metric*> drawn, measured;
};

/// Throws InputError for --envelope without pictures of lost bits.
MapMetrics select_map_metrics(const MapOptions& options, measure::metric::MetricSet& metric_set) {
    MapMetrics selected;
    selected.drawn = options.metrics.empty() ? std::vector{measure::metric::find_metric("lost_bits")}
                                             : selection::select_metrics(options.metrics, metric_set);
    if (!options.against.empty()) selection::add_comparison_metrics(selected.drawn);
    selected.measured = selected.drawn;
    if (!options.envelope) return selected;
    if (std::ranges::find(selected.drawn, measure::metric::find_metric("lost_bits")) == selected.drawn.end())
        throw InputError(
            "--envelope: marks pictures of lost_bits, but --metric does not draw them; add --metric lost_bits");
    selected.measured.push_back(measure::metric::find_metric("excess_bits"));
    return selected;
}

/// Loads the scenes. Prints which scenes and forms are left out, since nothing fits them.
std::vector<Scene> load_testable_scenes(const MapOptions& options, std::vector<TestedForm>& tested_forms,
                                        const CommonOptions& common) {
    auto scenes = selection::load_scenes(options.scenes, selection::data_folder(common.data));
    const auto handling_forms = selection::drop_unhandled(
        scenes, {tested_forms, options.forms, common.quiet},
        [](const Scene& scene, Shapes forms) { return scene.accepts(forms); },
        [](const Scene& scene) { return scene.id; });
    selection::note_unmeasured(options.forms, handling_forms, common.quiet);
    return scenes;
}

RunDivision divide_map(const MapOptions& options, const std::vector<PlannedScene>& planned_scenes,
                       const CommonOptions& common) {
    std::vector<std::filesystem::path> files;
    std::vector<std::string> jobs;
    for (const PlannedScene& planned : planned_scenes) {
        files.push_back(planned.map.scene->path);
        jobs.push_back(map_job(*planned.map.scene));
        if (planned.bits_needed) jobs.push_back(bits_needed_job(*planned.map.scene));
    }
    auto run_division = divide_run(options.shard, options.out, files, common);
    run_division.division.require_same_jobs(jobs);
    return run_division;
}

/// Prints on stderr what the run cannot measure.
void print_notes(const std::vector<PlannedScene>& planned_scenes, const MapOptions& options,
                 const std::vector<const Metric*>& drawn_metrics, bool quiet) {
    for (const PlannedScene& planned : planned_scenes)
        selection::note_forms_without_formula(drawn_metrics, planned.map.tested_forms, quiet);
    if (options.bits_needed > 0 && !quiet) note_forms_without_every_width(planned_scenes);
    for (const PlannedScene& planned : planned_scenes)
        selection::warn_of_ineffective_numbers(*planned.map.scene, options.scenes.set, planned.map.tested_forms, quiet);
}

/// Maps the scenes one after another. Returns the number of their rays without a proved truth.
std::uint64_t map_scenes(const std::vector<PlannedScene>& planned_scenes, const MapOptions& options,
                         const std::vector<const Metric*>& drawn_metrics, SceneFolders& folders,
                         RunDivision& run_division, const CommonOptions& common) {
    const measure::shard::Share share = run_division.division.share();
    std::uint64_t units = 0;
    for (const PlannedScene& planned : planned_scenes) units += planned.work_units();
    output::file::Progress progress(units / share.count, "map", common.progress, common.quiet);

    return folders.for_each(planned_scenes.size(), progress, [&](std::size_t scene_index, const auto& complete) {
        PlannedScene planned = planned_scenes[scene_index];  // a copy that may point to objects of this iteration
        const Scene& scene = *planned.map.scene;
        output::file::Estimate estimate(progress, scene.id,
                                        scene.pixel_count() * planned.map.tested_forms.size() / share.count,
                                        common.quiet, measure::study::Bands(scene, share).size());
        measure::truth::StageCounts stages;
        planned.map.progress = advance_callback(progress, &estimate);
        planned.map.stages = &stages;

        // Only the sheet of the first scene has explanations; the others refer to it.
        const std::string sheet = scene_index == 0 ? "" : planned_scenes.front().map.scene->id + "/contact";
        const auto applicable = selection::applicable_metrics(drawn_metrics, planned.map.tested_forms, scene.id);
        return map_scene(planned, options, find_measured_metrics(applicable, planned),
                         {common, progress, run_division, complete, sheet});
    });
}

ExitStatus run(MapOptions options, const CommonOptions& common) {
    require_folder(options.out);
    auto rows = selection::pair_forms_with_formats(selection::select_forms(options.forms),
                                                   selection::select_formats(options.formats));
    if (!options.against.empty()) selection::compare_against(rows, options.against, common.quiet);
    measure::metric::MetricSet metric_set;
    const MapMetrics metrics = select_map_metrics(options, metric_set);
    const auto scenes = load_testable_scenes(options, rows, common);
    // Checks the range and, below, the metrics: errors end the run before any work.
    static_cast<void>(selection::parse_range(options.range, metrics.drawn));
    const selection::ThreadLimit limit(common.threads);

    std::vector<PlannedScene> planned_scenes;
    for (const auto& scene : scenes)
        planned_scenes.push_back(plan_scene(scene, options, rows, metrics.measured, metric_set));
    for (const PlannedScene& planned : planned_scenes)
        selection::require_applicable_metrics(metrics.drawn, planned.map.tested_forms,
                                              "scene " + planned.map.scene->id);

    auto run_division = divide_map(options, planned_scenes, common);
    options.out = run_division.out.string();
    SceneFolders folders(scenes, run_division, common);
    print_notes(planned_scenes, options, metrics.drawn, common.quiet);
    const std::uint64_t unresolved = map_scenes(planned_scenes, options, metrics.drawn, folders, run_division, common);
    if (!finish_run(run_division, common)) return ExitStatus::done;
    for (const PlannedScene& planned : planned_scenes)
        note_suspicions(planned.map.tested_forms, common, [&planned](const TestedForm& tested_form) {
            return measure::contract::suspicion_text(*planned.map.scene, tested_form);
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

    // Pictures.
    command.add_list("--metric", options->metrics,
                     "Metrics to draw, by name or glob (default: lost_bits); see `lostbits list metrics`");
    command.add("--range", options->range,
                "Ends of the colour bar, LO:HI in the unit of the metric (default: those of the metric in each format; "
                "for lost_bits, all bits of the format)");
    selection::add_changes(command, options->scenes, "sphere[0].radius=10");
    selection::add_pixels(command, *options);
    selection::add_pictures(command, options->pictures);

    // Additional measurements and files.
    command.add(
        "--bits", options->bits_needed,
        "Correct bits of t that a hit must keep: also draw how many bits of precision each pixel needs for that",
        shell::whole_number_between(1, 52));
    command.add("--exr", options->exr,
                "Also write SCENE.exr, with the answers, outcomes and metrics of every pixel (docs/files.md)");
    command.add("--against", options->against,
                "Also compare every form with this form: draw and count the rays on which the answers differ");
    command.add(
        "--envelope", options->envelope,
        "In pictures of lost_bits, draw a pixel paler if the problem, not the formula, is to blame (inputs off by "
        "half an ulp would lose as much)");

    add_shard(command, options->shard);
    selection::add_out(command, options->out);
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
