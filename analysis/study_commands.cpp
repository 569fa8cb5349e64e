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
    const Common& common;
    RunDivision& run_division;
    output::file::Progress& progress;
};

/// Files that a study writes for a scene in addition to the usual ones; most studies have none.
template <class Adapter>
struct MoreFiles {
    using Study = typename Adapter::View::Study;
    MoreFiles(const Study&, const StudyRun&) {}
    static void add_option(const shell::Command&, StudyOptions&) {}
    static std::uint64_t pixels(const Study&, const study::StudyValues&) { return 0; }
    static std::vector<std::string> jobs(const Study&, const study::StudyValues&) { return {}; }
    [[nodiscard]] static std::vector<output::file::DataResource> resources() { return {}; }
    static void run(const Study&, shard::Division&) {}
};

/// The values at which a scene is measured along an axis.
struct Steps {
    SceneAxis axis;
    std::vector<double> values;
};
std::vector<Steps> steps_of(const study::StudyValues& values) {
    std::vector<Steps> all;
    const auto& axis_names = values.at("along");
    for (std::size_t k = 0; k < measure::offset::scene_axis_names.size(); ++k) {
        const auto axis = static_cast<SceneAxis>(k);
        if (std::ranges::find(axis_names, name_of(axis)) != axis_names.end())
            all.push_back({axis, measure::offset::factors_along(axis)});
    }
    return all;
}

std::string job_of(const OffsetStudy& study, SceneAxis axis, double value) {
    return fmt::format("offsets {} along {} {}", study.scene.id, name_of(axis), value);
}

/// Takes the pieces of a study that has no pictures.
struct NoFiles {
    [[nodiscard]] static measure::study::ShowBand<OffsetStudy> show() { return {}; }
    static void put(std::uint64_t, const output::pixel::Piece&) {}
};

/// The files of --along: the scene, measured at every position along an axis.
template <>
class MoreFiles<study::OffsetsAdapter> {
public:
    MoreFiles(const OffsetStudy& study, const StudyRun& run) : steps_(steps_of(run.options.values)) {
        const auto folder = run.run_division.path_to_write(run.run_division.out / study.scene.id);
        for (const Steps& steps : steps_)
            if (!folder.empty())
                files_.push_back(std::make_unique<output::offset::AlongFiles>(folder, study, steps.axis));
    }

    static void add_option(const shell::Command& command, StudyOptions& o) {
        command.add_list(
            "--along", o.values["along"],
            "Also measure the scene as it changes along an axis: distance (of the eye), radius (every length), world "
            "(everything moved); pictures of 48 columns",
            shell::one_of({measure::offset::scene_axis_names.begin(), measure::offset::scene_axis_names.end()}));
    }
    static std::uint64_t pixels(const OffsetStudy& study, const study::StudyValues& values) {
        std::uint64_t pixels = 0;
        for (const Steps& steps : steps_of(values))
            for (const double factor : steps.values)
                pixels += measure::offset::moved_along(study.scene, steps.axis, factor).pixels();
        return pixels;
    }
    static std::vector<std::string> jobs(const OffsetStudy& study, const study::StudyValues& values) {
        std::vector<std::string> jobs;
        for (const Steps& steps : steps_of(values))
            for (const double factor : steps.values) jobs.push_back(job_of(study, steps.axis, factor));
        return jobs;
    }

    [[nodiscard]] std::vector<output::file::DataResource> resources() const {
        std::vector<output::file::DataResource> all;
        for (const auto& files : files_) all.push_back(files->resource());
        return all;
    }
    void run(const OffsetStudy& study, shard::Division& division) {
        for (std::size_t a = 0; a < steps_.size(); ++a) {
            for (const double factor : steps_[a].values) {
                const Scene moved_scene = measure::offset::moved_along(study.scene, steps_[a].axis, factor);
                const OffsetStudy moved_study{.scene = moved_scene,
                                              .rows = study.rows,
                                              .strategies = study.strategies,
                                              .limit = study.limit,
                                              .progress = study.progress};
                NoFiles no_files;
                auto found = shard::run_divided(moved_study, no_files, division, job_of(study, steps_[a].axis, factor));
                if (found) files_[a]->add(factor, std::move(*found));
            }
            if (!files_.empty()) files_[a]->finish();
        }
    }

private:
    std::vector<Steps> steps_;
    std::vector<std::unique_ptr<output::offset::AlongFiles>> files_;  ///< one for each axis; none in a shard
};

/// The number of pixels of all rows of a study and of its further files.
template <class Adapter>
std::uint64_t units_of(const typename Adapter::View::Study& study, const study::StudyValues& values) {
    return (study.scene.pixels() + MoreFiles<Adapter>::pixels(study, values)) * study.rows.size();
}

/// Measures one scene, and writes and prints its results. Returns the number of its rays without a proved truth; 0 in a
/// shard.
template <class Adapter>
std::uint64_t measure_scene(typename Adapter::View::Study study, const StudyRun& run,
                            const SceneFolders::CompleteCallback& complete) {
    const StudyOptions& o = run.options;
    const std::string job = fmt::format("{} {}", Adapter::name, study.scene.id);
    const auto folder = run.run_division.out / study.scene.id;
    const std::string scene_arguments = selection::name_of_scene(study.scene, selection::data_folder(run.common.data));
    MoreFiles<Adapter> more(study, run);
    output::study::StudyFiles<typename Adapter::View> files(
        study,
        {.folder = folder,
         .pixels_csv = o.pixels == "csv",
         .command = run.common.typed_command.for_subject(scene_arguments),
         .single_pictures = o.pictures == "all",
         .other_tables = more.resources()},
        shard::piece_recorder(run.run_division.division, job));
    // Opening the files of many forms takes seconds, so the estimate starts after it.
    output::file::Estimate estimate(run.progress, study.scene.id,
                                    units_of<Adapter>(study, o.values) / run.run_division.division.share().count,
                                    run.common.quiet);
    study.progress = advance_callback(run.progress, &estimate);
    const auto summaries = shard::run_divided(study, files, run.run_division.division, job);
    more.run(study, run.run_division.division);
    if (!summaries) return 0;
    files.finish(*summaries);
    complete();
    if (!run.common.quiet) {
        run.progress.aside([&] {
            print_figures(folder / "contact.png");
            Adapter::print_results(study, *summaries, run.common.verbose);
        });
    }
    return Adapter::unproved(*summaries);
}

template <class Adapter>
Exit run_command(const StudyOptions& o, const Common& common) {
    require_folder(o.out);
    auto rows = selection::cross(selection::select_forms(selection::form_patterns_or(o.forms, Adapter::usual_forms())),
                                 selection::select_formats(o.formats));
    std::erase_if(rows, [](const auto& form_row) { return !Adapter::can_measure(*form_row.form); });
    if (rows.empty()) throw NothingSelected(Adapter::no_form_message);
    auto scenes = scenes_of_primitives(o, rows, Adapter::name, common, Adapter::require);
    const selection::ThreadLimit limit(common.threads);

    std::vector<typename Adapter::View::Study> studies;
    std::vector<std::string> jobs;
    std::vector<std::filesystem::path> input_files;
    std::uint64_t units = 0;
    for (const scene::file::Scene& scene : scenes) {
        const auto meets = [&](Shapes forms) { return scene.meets(forms); };
        studies.push_back(Adapter::make_study(scene, selection::fitting(rows, meets), o.values, common.stop));
        if constexpr (requires { Adapter::note(scene, o.values); })
            if (!common.quiet) Adapter::note(scene, o.values);
        jobs.push_back(fmt::format("{} {}", Adapter::name, scene.id));
        std::ranges::move(MoreFiles<Adapter>::jobs(studies.back(), o.values), std::back_inserter(jobs));
        input_files.push_back(scene.path);
        units += units_of<Adapter>(studies.back(), o.values);
    }
    auto run_division = divide_run(o.shard, o.out, input_files, common);
    run_division.division.expect(jobs);
    SceneFolders folders(scenes, run_division, common);
    for (const auto& scene : scenes) selection::note_numbers(scene, o.scenes.set, rows, common.quiet);

    output::file::Progress progress(units / run_division.division.share().count, Adapter::name, common.progress,
                                    common.quiet);
    const StudyRun run{o, common, run_division, progress};
    const std::uint64_t unproved = folders.for_each(studies.size(), progress, [&](std::size_t k, const auto& complete) {
        return measure_scene<Adapter>(studies[k], run, complete);
    });
    finish_run(run_division, common);
    return report_unproved(unproved, studies.front().limit.max_bits);
}

template <class Adapter>
void add_study(const shell::Command& program, const Common& common) {
    auto command = program.add_command(Adapter::name, Adapter::title);
    const auto o = std::make_shared<StudyOptions>();
    if (const std::vector<std::string> all{"*"}; Adapter::usual_forms() == all) o->forms = all;
    o->formats = {study::usual_format};
    o->scenes.stop = common.stop;
    o->scenes.refuses_ranges = true;
    selection::add_scenes(command, *o, Adapter::kinds);
    command.add_list("-i,--form", o->forms, Adapter::form_help);
    selection::add_formats(command, o->formats, study::usual_format);
    for (const study::StudyOption& option : Adapter::options()) {
        auto& values = o->values[option.name] = option.usual;
        command.add_list("--" + option.name, values, option.help,
                         option.known.empty() ? shell::ValueRule{} : shell::one_of(option.known));
    }
    selection::add_changes(command, o->scenes, Adapter::example);
    if constexpr (requires { Adapter::View::pixel_title; }) selection::add_pixels(command, *o);
    selection::add_pictures(command, o->pictures);
    MoreFiles<Adapter>::add_option(command, *o);
    add_shard(command, o->shard);
    selection::add_out(command, o->out);
    command.set_examples(Adapter::examples());
    command.runs([o, &common] { return run_command<Adapter>(*o, common); });
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
