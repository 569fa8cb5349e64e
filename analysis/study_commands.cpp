// The commands of the studies: their options, scenes, files and shards.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "analysis/selection/external.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/shard/pieces.hpp"
#include "analysis/study/studies.hpp"
#include "commands.hpp"
#include "measure/offset/along.hpp"

namespace lostbits::analysis {

using measure::offset::OffsetStudy;
using measure::offset::SceneAxis;
using scene::file::Scene;

namespace {

struct StudyOptions : selection::SharedOptions {
    study::StudyValues values;
    std::string shard;
};

/// The run of a study over several scenes.
struct StudyRun {
    const StudyOptions& options;
    const CommonOptions& common;
    RunDivision& run_division;
    output::file::Progress& progress;
};

/// Files that a study writes for a scene in addition to the usual ones; most studies have none.
template <class Adapter>
struct ExtraFiles {
    using Study = typename Adapter::Presentation::Study;
    ExtraFiles(const Study&, const StudyRun&) {}
    static void add_option(const shell::Command&, StudyOptions&) {}
    static std::uint64_t pixels(const Study&, const study::StudyValues&) { return 0; }
    static std::vector<std::string> jobs(const Study&, const study::StudyValues&) { return {}; }
    [[nodiscard]] static std::vector<output::file::DataResource> resources() { return {}; }
    static void run(const Study&, shard::Division&) {}
};

/// The values at which a scene is measured along an axis.
struct AxisSteps {
    SceneAxis axis;
    std::vector<double> values;
};
std::vector<AxisSteps> selected_steps(const study::StudyValues& values) {
    std::vector<AxisSteps> all;
    const auto& axis_names = values.at("along");
    for (std::size_t k = 0; k < measure::offset::scene_axis_names.size(); ++k) {
        const auto axis = static_cast<SceneAxis>(k);
        if (std::ranges::find(axis_names, name_of(axis)) != axis_names.end())
            all.push_back({axis, measure::offset::factors_along(axis)});
    }
    return all;
}

std::string job_name(const OffsetStudy& study, SceneAxis axis, double value) {
    return fmt::format("offsets {} along {} {}", study.scene.id, name_of(axis), value);
}

/// Takes the pieces of a study that has no pictures.
struct NoFiles {
    [[nodiscard]] static measure::study::ShowBand<OffsetStudy> show() { return {}; }
    static void put(std::uint64_t, const output::pixel::Piece&) {}
};

/// The files of --along: the scene, measured at every position along an axis.
template <>
class ExtraFiles<study::OffsetsAdapter> {
public:
    ExtraFiles(const OffsetStudy& study, const StudyRun& run) : steps_(selected_steps(run.options.values)) {
        const auto folder = run.run_division.path_to_write(run.run_division.out / study.scene.id);
        for (const AxisSteps& steps : steps_)
            if (!folder.empty())
                writers_.push_back(std::make_unique<output::offset::OffsetsAlongAxisWriter>(folder, study, steps.axis));
    }

    static void add_option(const shell::Command& command, StudyOptions& options) {
        command.add_list(
            "--along", options.values["along"],
            "Also measure the scene as it changes along an axis: distance (of the eye), radius (every length), world "
            "(everything moved); pictures of 48 columns",
            shell::one_of({measure::offset::scene_axis_names.begin(), measure::offset::scene_axis_names.end()}));
    }
    static std::uint64_t pixels(const OffsetStudy& study, const study::StudyValues& values) {
        std::uint64_t pixels = 0;
        for (const AxisSteps& steps : selected_steps(values))
            for (const double factor : steps.values)
                pixels += measure::offset::move_along(study.scene, steps.axis, factor).pixel_count();
        return pixels;
    }
    static std::vector<std::string> jobs(const OffsetStudy& study, const study::StudyValues& values) {
        std::vector<std::string> jobs;
        for (const AxisSteps& steps : selected_steps(values))
            for (const double factor : steps.values) jobs.push_back(job_name(study, steps.axis, factor));
        return jobs;
    }

    [[nodiscard]] std::vector<output::file::DataResource> resources() const {
        std::vector<output::file::DataResource> all;
        for (const auto& writer : writers_) all.push_back(writer->resource());
        return all;
    }
    void run(const OffsetStudy& study, shard::Division& division) {
        for (std::size_t a = 0; a < steps_.size(); ++a) {
            for (const double factor : steps_[a].values) {
                const Scene moved_scene = measure::offset::move_along(study.scene, steps_[a].axis, factor);
                const OffsetStudy moved_study{.scene = moved_scene,
                                              .tested_forms = study.tested_forms,
                                              .strategies = study.strategies,
                                              .limit = study.limit,
                                              .progress = study.progress};
                NoFiles no_files;
                auto summaries =
                    shard::run_divided(moved_study, no_files, division, job_name(study, steps_[a].axis, factor));
                if (summaries) writers_[a]->add(factor, std::move(*summaries));
            }
            if (!writers_.empty()) writers_[a]->finish();
        }
    }

private:
    std::vector<AxisSteps> steps_;
    /// One for each axis; none in a shard.
    std::vector<std::unique_ptr<output::offset::OffsetsAlongAxisWriter>> writers_;
};

/// The number of pixels of all rows of a study and of its further files.
template <class Adapter>
std::uint64_t count_units(const typename Adapter::Presentation::Study& study, const study::StudyValues& values) {
    return (study.scene.pixel_count() + ExtraFiles<Adapter>::pixels(study, values)) * study.tested_forms.size();
}

/// Measures one scene, and writes and prints its results. Returns the number of its rays without a proved truth; 0 in a
/// shard.
template <class Adapter>
std::uint64_t measure_scene(typename Adapter::Presentation::Study study, const StudyRun& run,
                            const SceneFolders::CompleteCallback& complete) {
    const StudyOptions& options = run.options;
    const std::string job = fmt::format("{} {}", Adapter::name, study.scene.id);
    const auto folder = run.run_division.out / study.scene.id;
    const std::string scene_arguments =
        selection::scene_arguments(study.scene, selection::data_folder(run.common.data));

    ExtraFiles<Adapter> extra_files(study, run);
    output::study::StudyWriter<typename Adapter::Presentation> writer(
        study,
        {.folder = folder,
         .writes_pixels_csv = options.pixels == "csv",
         .command = run.common.typed_command.for_subject(scene_arguments),
         .draws_single_pictures = options.pictures == "all",
         .other_tables = extra_files.resources()},
        shard::piece_recorder(run.run_division.division, job));

    // Opening the files of many forms takes seconds, so the estimate starts after it.
    output::file::Estimate estimate(
        run.progress, study.scene.id,
        count_units<Adapter>(study, options.values) / run.run_division.division.share().count, run.common.quiet);
    study.progress = advance_callback(run.progress, &estimate);
    const auto summaries = shard::run_divided(study, writer, run.run_division.division, job);
    extra_files.run(study, run.run_division.division);
    if (!summaries) return 0;
    writer.finish(*summaries);
    complete();
    if (!run.common.quiet) {
        run.progress.print_without_bar([&] {
            print_figure_paths(folder / "contact.png");
            Adapter::print_results(study, *summaries, run.common.verbose);
        });
    }
    return Adapter::unproved_count(*summaries);
}

/// The studies of the scenes, and what they need.
template <class Adapter>
struct PlannedStudies {
    std::vector<typename Adapter::Presentation::Study> studies = {};
    std::vector<std::string> jobs = {};
    std::vector<std::filesystem::path> input_files = {};
    std::uint64_t units = 0;
};

template <class Adapter>
PlannedStudies<Adapter> plan_studies(const std::vector<Scene>& scenes,
                                     const std::vector<measure::evaluate::TestedForm>& tested_forms,
                                     const StudyOptions& options, const CommonOptions& common) {
    PlannedStudies<Adapter> planned;
    for (const Scene& scene : scenes) {
        const auto can_test = [&](Shapes forms) { return scene.accepts(forms); };
        planned.studies.push_back(Adapter::make_study(scene, selection::filter_tested_forms(tested_forms, can_test),
                                                      options.values, common.stop));
        if constexpr (requires { Adapter::print_missing_stages(scene, options.values); })
            if (!common.quiet) Adapter::print_missing_stages(scene, options.values);
        planned.jobs.push_back(fmt::format("{} {}", Adapter::name, scene.id));
        std::ranges::move(ExtraFiles<Adapter>::jobs(planned.studies.back(), options.values),
                          std::back_inserter(planned.jobs));
        planned.input_files.push_back(scene.path);
        planned.units += count_units<Adapter>(planned.studies.back(), options.values);
    }
    return planned;
}

template <class Adapter>
ExitStatus run_command(const StudyOptions& options, const CommonOptions& common) {
    require_folder(options.out);
    auto rows = selection::pair_forms_with_formats(
        selection::select_forms(selection::form_patterns(options.forms, Adapter::usual_forms())),
        selection::select_formats(options.formats));
    std::erase_if(rows, [](const auto& tested_form) { return !Adapter::can_measure(*tested_form.form); });
    if (rows.empty()) throw NothingSelected(Adapter::no_form_message);
    const auto scenes = load_primitive_scenes(options, rows, Adapter::name, common, Adapter::require);
    const selection::ThreadLimit limit(common.threads);
    auto planned = plan_studies<Adapter>(scenes, rows, options, common);
    auto run_division = divide_run(options.shard, options.out, planned.input_files, common);
    run_division.division.require_same_jobs(planned.jobs);
    SceneFolders folders(scenes, run_division, common);
    for (const auto& scene : scenes)
        selection::warn_of_ineffective_numbers(scene, options.scenes.set, rows, common.quiet);

    output::file::Progress progress(planned.units / run_division.division.share().count, Adapter::name, common.progress,
                                    common.quiet);
    const StudyRun run{options, common, run_division, progress};
    const std::uint64_t unproved = folders.for_each(
        planned.studies.size(), progress,
        [&](std::size_t k, const auto& complete) { return measure_scene<Adapter>(planned.studies[k], run, complete); });
    finish_run(run_division, common);
    return report_unproved(unproved, planned.studies.front().limit.max_bits);
}

template <class Adapter>
void add_study(const shell::Command& program, const CommonOptions& common) {
    auto command = program.add_command(Adapter::name, Adapter::title);
    const auto options = std::make_shared<StudyOptions>();
    if (const std::vector<std::string> all{"*"}; Adapter::usual_forms() == all) options->forms = all;
    options->formats = {study::usual_format};
    options->scenes.stop = common.stop;
    options->scenes.refuses_ranges = true;

    selection::add_scenes(command, *options, Adapter::kinds);
    command.add_list("-i,--form", options->forms, Adapter::form_help);
    selection::add_formats(command, options->formats, study::usual_format);
    for (const study::StudyOption& option : Adapter::options()) {
        auto& values = options->values[option.name] = option.default_values;
        command.add_list("--" + option.name, values, option.help,
                         option.allowed_values.empty() ? shell::ValueRule{} : shell::one_of(option.allowed_values));
    }

    selection::add_changes(command, options->scenes, Adapter::example);
    if constexpr (requires { Adapter::Presentation::pixel_title; }) selection::add_pixels(command, *options);
    selection::add_pictures(command, options->pictures);
    ExtraFiles<Adapter>::add_option(command, *options);
    add_shard(command, options->shard);
    selection::add_out(command, options->out);
    command.set_examples(Adapter::examples());
    command.set_action([options, &common] { return run_command<Adapter>(*options, common); });
}

}  // namespace

std::vector<NamedCommand> study_commands() {
    return std::apply(
        [](auto... adapter) {
            return std::vector<NamedCommand>{{adapter.name, add_study<decltype(adapter)>}...};
        },
        study::Studies());
}

}  // namespace lostbits::analysis
