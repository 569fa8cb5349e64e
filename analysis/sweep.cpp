#include "measure/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>

#include "analysis/selection/external.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/selection/sweep_options.hpp"
#include "analysis/study/measurements.hpp"
#include "commands.hpp"
#include "measure/contract/suspect.hpp"
#include "output/sweep/case_files.hpp"
#include "output/sweep/sweep_files.hpp"
#include "output/sweep/sweep_plots.hpp"
#include "sweep_kinds.hpp"

namespace lostbits::analysis {

using measure::evaluate::TestedForm;
using scene::sweep::SweepKind;

namespace {

void print_onsets(const measure::sweep::SweepRequest& request, const std::vector<measure::sweep::Onset>& onsets) {
    fmt::print("  {:<28}  {:<6}  {:<13}  {:<9}  {:>9}  {:<9}  {:>14}  {:>14}  {:>15}  {}\n", "form", "format", "event",
               "statistic", "threshold", "read_from", "last_good", "first_bad", "last_good_after",
               "first_bad over draws");
    for (const measure::sweep::Onset& onset : onsets) {
        // An onset from the last step says nothing if that step is bad already.
        if (!onset.found || (onset.reads_backwards && onset.happens_at_start)) continue;
        const TestedForm& tested_form = request.tested_forms[onset.form_index];
        // If the first step is bad already, there is no last good value.
        const auto spread = onset.spread();
        fmt::print("  {:<28}  {:<6}  {:<13}  {:<9}  {:>9}  {:<9}  {:>14}  {:>14.8g}  {:>15}  {}\n",
                   tested_form.form->info->name, tested_form.format.name, onset.event, onset.statistic, onset.threshold,
                   onset.reads_backwards ? "last" : "first",
                   onset.happens_at_start ? "-" : fmt::format("{:.8g}", onset.last_good), onset.first_bad,
                   !onset.recovers        ? "-"
                   : onset.is_good_at_end ? "to the end"
                                          : fmt::format("{:.8g}", onset.last_good_after),
                   onset.further_first_bad.empty()
                       ? ""
                       : fmt::format("{:.4g} to {:.4g}, median {:.4g}", spread.low, spread.high, spread.median));
    }
}

/// Runs a file of named cases; its result is the matrix of cases.
void run_case_file(const std::filesystem::path& path, const SweepSelection& chosen) {
    const scene::sweep::CaseFile file(path);
    const auto tested_forms =
        selection::filter_tested_forms(chosen.tested_forms, [&](Shapes forms) { return file.accepts(forms); });
    measure::sweep::CaseRequest request{.file = file,
                                        .tested_forms = study::with_each_convention(file, tested_forms),
                                        .metrics = {},
                                        .limit = {.stop = chosen.common.stop}};
    request.metrics = chosen.metric_set.adapt_to_forms(
        selection::with_default_metrics(chosen.extra_metrics, tested_forms), measure::evaluate::forms_of(tested_forms),
        [&file] { return measure::attribution::OwnedSetting(file.rays(0, binary64).front()); });
    if (!chosen.common.quiet) selection::note_unrepresentable_numbers(file, tested_forms);

    const auto folder = chosen.folder_of(file.id);
    const auto result_folder = chosen.lock_sweep_folder(file.id, path);
    std::optional<output::sweep::CaseWriter> files;
    if (result_folder) files.emplace(request, folder, selection::sweep_argument(path, chosen.data()));
    request.share = chosen.division().share();
    const auto units = request.share.unit_range(file.size()).size() * request.tested_forms.size();
    const auto case_results = chosen.measure_or_join(file.id, units, request, measure::sweep::run_cases);
    if (!case_results) return;

    files->finish(*case_results);
    complete_folder(result_folder);
    if (!chosen.common.quiet) fmt::print("{}\n", (folder / "cases.csv").string());
}

/// Prints on stderr which forms seem to have another contract than they state, by the rays of the first step.
void note_suspicions_at_start(const scene::sweep::SweepFile& sweep, const std::vector<TestedForm>& tested_forms,
                              const CommonOptions& common) {
    note_suspicions(tested_forms, common, [&sweep](const TestedForm& tested_form) {
        std::vector<double> first_values;
        std::string position;
        for (const scene::sweep::Axis& axis : sweep.axes) {
            first_values.push_back(axis.values.front());
            position += fmt::format("{}{} = {}", position.empty() ? " at " : ", ", axis.name, first_values.back());
        }
        return measure::contract::suspicion_text(sweep.rays(first_values), tested_form,
                                                 sweep.id + position + ", the first step");
    });
}

void run_axes(const std::filesystem::path& path, const SweepSelection& chosen) {
    const CommonOptions& common = chosen.common;
    scene::sweep::SweepFile sweep(path, chosen.data(), selection::read_changes(chosen.options), common.stop);
    sweep.title += chosen.options.title_suffix();
    auto request = study::sweep_request(
        sweep, selection::filter_tested_forms(chosen.tested_forms, [&](Shapes forms) { return sweep.accepts(forms); }),
        chosen.extra_metrics, chosen.metric_set, common.stop);
    if (chosen.options.seeds) request.further_draw_count = *chosen.options.seeds;
    selection::note_forms_without_formula(chosen.extra_metrics, request.tested_forms, common.quiet);
    output::sweep::SweepWriter::require_own_columns(request);
    if (!common.quiet) selection::note_unrepresentable_numbers(sweep, request.tested_forms, common.stop);

    const auto folder = chosen.folder_of(sweep.id);
    const auto result_folder = chosen.lock_sweep_folder(sweep.id, path);
    const auto files = result_folder ? std::make_unique<output::sweep::SweepWriter>(request, folder) : nullptr;
    request.share = chosen.division().share();
    const auto units = measure::sweep::count_sweep_units(request) / request.share.count;
    const auto measured_sweep = chosen.measure_or_join(sweep.id, units, request, measure::sweep::measure_sweep);
    if (!measured_sweep) return;

    const auto& [steps, onsets] = *measured_sweep;
    output::sweep::write_sweep_plots(folder, {request, steps, onsets}, chosen.options.pictures == "all");
    files->finish(steps, onsets);
    complete_folder(result_folder);
    note_suspicions_at_start(sweep, request.tested_forms, common);
    if (common.quiet) return;
    fmt::print("{}\n", (folder / "samples.csv").string());
    if (common.verbose && !onsets.empty()) print_onsets(request, onsets);
}

using selection::ShapePredicate;

/// Throws InputError for options that a sweep along axes does not take.
void require_axes_options(const scene::sweep::SweepFile& sweep, const SweepOptions& options) {
    const char* const no_seeds_reason = !sweep.has_random_rays() ? "has the rays of its scene and draws none at random"
                                        : sweep.axes.size() != 1
                                            ? "has two axes; more seeds repeat the onset of a sweep along one axis"
                                            : nullptr;
    if (no_seeds_reason != nullptr && options.seeds.value_or(0) > 0)
        throw InputError(
            fmt::format("--seeds {}: {} {}; leave out --seeds", *options.seeds, sweep.id, no_seeds_reason));
    if (options.pictures == "all" && sweep.axes.size() != 2)
        throw InputError(fmt::format(
            "--pictures all: {} has one axis, and each plot shows all forms; leave out --pictures", sweep.id));
}

/// Throws InputError if the metric of a search is unknown, or if none of its values is the largest.
void require_search_metric(const std::filesystem::path& path, const std::string& name) {
    measure::metric::MetricSet metric_set;
    const measure::metric::Metric* const metric = metric_set.find(name);
    if (metric == nullptr) {
        std::vector<std::string> names;
        for (const measure::metric::Metric& known : measure::metric::metrics()) names.emplace_back(known.name);
        throw InputError(path.string() + ":1:1: search.metric is \"" + name + "\", which is not a metric; " +
                         text::did_you_mean(name, names));
    }
    if (metric->depends_on_forms)
        throw InputError(path.string() + ":1:1: search.metric is \"" + name +
                         "\", whose values are names of operations, so none of them is the largest; try cancellation, "
                         "or contribution:LABEL");
}

/// Checks the file and the options. Returns a function that tells which forms can test the file. Throws InputError.
ShapePredicate check_file(const std::filesystem::path& path, SweepKind kind, const SweepOptions& options,
                          const std::filesystem::path& data, intersect::process::StopToken stop) {
    using K = SweepKind;
    const bool is_search = kind == K::search || kind == K::edge_search;
    if (options.worst && !is_search)
        throw InputError(path.string() +
                         ":1:1: --worst needs a [search] table with the ranges to search, or an "
                         "[edge_search] table; see data/sweeps/worst");
    if (!options.worst && is_search)
        throw InputError(path.string() +
                         ":1:1: this file has a table for a search, which only --worst uses; add --worst");
    selection::require_allowed_changes(options, kind, path.stem().string());

    // Each kind has its own file, which is read here for its errors too.
    const auto accepts_only = [](Shape shape) { return [shape](Shapes forms) { return forms == shape; }; };
    if (kind == K::cases) return [file = scene::sweep::CaseFile(path)](Shapes forms) { return file.accepts(forms); };
    if (kind == K::every_float) return accepts_only(scene::sweep::ExhaustiveFile(path, data, stop).primitive.shape);
    if (kind == K::edge_search)
        return [file = scene::sweep::EdgeSearchFile(path, data, selection::read_changes(options).set, stop)](
                   Shapes forms) { return file.accepts(forms); };
    if (kind == K::axes) {
        const scene::sweep::SweepFile sweep(path, data, selection::read_changes(options), stop);
        require_axes_options(sweep, options);
        return [sweep](Shapes forms) { return sweep.accepts(forms); };
    }
    const scene::sweep::SearchFile search(path, selection::read_changes(options).set);
    require_search_metric(path, search.metric);
    return accepts_only(search.shape);
}

/// Resumes the sweeps that have a state. When a run of several sweeps is stopped, those before the stopped one have
/// their final state, and those after it have none. Without any state, `resume` throws.
void resume_stopped(const std::vector<std::unique_ptr<ExhaustiveRun>>& runs) {
    const bool has_stopped_run = std::ranges::any_of(runs, [](const auto& run) { return run->was_stopped(); });
    for (const auto& run : runs)
        if (!has_stopped_run || run->was_stopped()) run->read_saved_state();
}

/// A sweep of the run: its file, and the forms that can test it.
struct PlannedSweepFile {
    std::filesystem::path path;
    SweepKind kind;
    ShapePredicate can_test;
};

/// Selects the forms and metrics of the run.
void select_forms_and_metrics(SweepSelection& chosen) {
    const SweepOptions& options = chosen.options;
    const std::vector<std::string> default_formats{"f32", "f64"};
    chosen.tested_forms = selection::pair_forms_with_formats(
        selection::select_forms(options.forms),
        selection::select_formats(options.formats.empty() ? default_formats : options.formats));
    if (!options.against.empty()) selection::compare_against(chosen.tested_forms, options.against, chosen.common.quiet);

    if (!options.metrics.empty()) chosen.extra_metrics = selection::select_metrics(options.metrics, chosen.metric_set);
    if (!options.against.empty()) selection::add_comparison_metrics(chosen.extra_metrics);
    // The plots of a sweep have the envelope, which is the error that the problem itself costs.
    for (const char* name : {"inherent_bits", "excess_bits"})
        chosen.extra_metrics.push_back(measure::metric::find_metric(name));
}

/// Reads every file before the work starts, so that bad input leaves no results behind.
std::vector<PlannedSweepFile> plan_sweeps(const SweepOptions& options, const std::filesystem::path& data,
                                          intersect::process::StopToken stop) {
    std::vector<PlannedSweepFile> sweeps;
    for (const std::string& name : options.sweeps) {
        const auto path = scene::sweep::find_sweep(name, data);
        const auto kind = scene::sweep::read_sweep_kind(path);
        for (const PlannedSweepFile& other : sweeps) {
            if (other.path.stem() == path.stem())
                throw InputError(
                    name + ": sweep \"" + path.stem().string() +
                    "\" is given twice, and both would write to the same folder; leave out one of the two");
        }
        if (kind != SweepKind::every_float && options.resume)
            throw InputError(
                "--resume: " + path.stem().string() +
                " is not a sweep over every float, and other sweeps cannot be resumed; leave out --resume");
        sweeps.push_back({path, kind, check_file(path, kind, options, data, stop)});
    }
    return sweeps;
}

/// Drops the sweeps that no form can test, and prints what is left out.
void drop_untestable(std::vector<PlannedSweepFile>& sweeps, SweepSelection& chosen) {
    const auto handling_forms = selection::drop_unhandled(
        sweeps, {chosen.tested_forms, chosen.options.forms, chosen.common.quiet},
        [](const PlannedSweepFile& planned, Shapes forms) { return planned.can_test(forms); },
        [](const PlannedSweepFile& planned) { return planned.path.stem().string(); });
    selection::note_unmeasured(chosen.options.forms, handling_forms, chosen.common.quiet);
}

RunDivision divide_sweeps(const std::vector<PlannedSweepFile>& sweeps, const SweepOptions& options,
                          const std::filesystem::path& data, const CommonOptions& common) {
    std::vector<std::filesystem::path> files;
    std::vector<std::string> jobs;
    for (const PlannedSweepFile& sweep : sweeps) {
        std::ranges::move(selection::list_input_files(sweep.path, sweep.kind, options, data, common.stop),
                          std::back_inserter(files));
        jobs.push_back("sweep " + sweep.path.stem().string());
    }
    RunDivision run_division = divide_run(options.shard, options.out, files, common, options.resume);
    run_division.division.require_same_jobs(jobs);
    return run_division;
}

/// Runs a sweep of any kind but every float.
void run_sweep(const PlannedSweepFile& sweep, const SweepSelection& chosen) {
    try {
        if (sweep.kind == SweepKind::cases) run_case_file(sweep.path, chosen);
        else if (sweep.kind == SweepKind::axes) run_axes(sweep.path, chosen);
        else if (sweep.kind == SweepKind::search) run_search(sweep.path, chosen);
        else if (sweep.kind == SweepKind::edge_search) run_edge_search(sweep.path, chosen);
    } catch (const Interrupted&) {
        throw Error(ExitStatus::interrupted, selection::interrupted_text(sweep.kind, sweep.path.stem().string()));
    }
}

ExitStatus run(SweepOptions options, const CommonOptions& common) {
    measure::metric::MetricSet metric_set;
    RunDivision run_division;
    SweepSelection chosen{{}, {}, metric_set, run_division, options, common};
    select_forms_and_metrics(chosen);
    require_folder(options.out);
    const auto data = selection::data_folder(common.data);
    auto sweeps = plan_sweeps(options, data, common.stop);
    drop_untestable(sweeps, chosen);
    run_division = divide_sweeps(sweeps, options, data, common);
    options.out = run_division.out.string();

    // Sweeps over every float can be resumed, and run after the others.
    std::vector<std::unique_ptr<ExhaustiveRun>> exhaustive_runs;
    for (const PlannedSweepFile& sweep : sweeps) {
        if (sweep.kind == SweepKind::every_float)
            exhaustive_runs.push_back(std::make_unique<ExhaustiveRun>(sweep.path, chosen));
    }
    if (options.resume) resume_stopped(exhaustive_runs);

    const selection::ThreadLimit limit(common.threads);
    for (const PlannedSweepFile& sweep : sweeps) run_sweep(sweep, chosen);
    std::uint64_t unproved = 0;
    for (const auto& run : exhaustive_runs) unproved += run->run(exhaustive_runs.size() > 1);
    finish_run(run_division, common);
    for (const auto& run : exhaustive_runs) run->forget_state();
    return report_unproved(unproved);
}

}  // namespace

void add_sweep(const shell::Command& program, const CommonOptions& common) {
    auto command = program.add_command("sweep",
                                       "Measure errors along a parameter, and find where they first cross a "
                                       "threshold");
    const auto options = std::make_shared<SweepOptions>();
    command.add("SWEEP", options->sweeps, "Sweep files or names in data/sweeps").required();
    selection::add_forms(command, options->forms);
    command.add_list(
        "-f,--format", options->formats,
        "Formats: f32, f64, fp16, bf16, tf32, pN, pA..pB (default: f32 f64; f32 for sweeps over every float)");
    command.add_list("--metric", options->metrics, "Also measure these metrics, by name or glob");

    // Changes of the sweep.
    command.add(
        "--seeds", options->seeds,
        "Repeat with this many other random sets of rays, and find where the form starts to fail in each (default: 2)",
        shell::whole_number_between(0, 1000));
    command.add("--size", options->size,
                "Picture size of the sweep's scene, WxH; each step has one ray per pixel (default: the scene's)");
    command.add("--steps", options->steps, "Steps of each axis: 40, or 40,20 (default: the file's)");
    command.add_set(options->set, "Change a number of the sweep first: views=64, axis[0].to=100, march.hit_eps=1e-6");

    command.add("--worst", options->worst, "Search the ranges of a [search] file for the worst ray of each form");
    command.add("--resume", options->resume, "Continue a stopped sweep over every float");
    command.add("--against", options->against, "Also compare every form with this form");
    add_shard(command, options->shard);
    selection::add_pictures(command, options->pictures);
    selection::add_out(command, options->out);
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
