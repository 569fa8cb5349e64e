#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analysis/selection/external.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "measure/choose/file_rays.hpp"
#include "measure/repair/price.hpp"
#include "number/error.hpp"
#include "output/choose/choice_files.hpp"
#include "output/file/atomic_file.hpp"
#include "output/repair/form_code.hpp"
#include "output/repair/repair_files.hpp"

namespace lostbits::analysis {

using measure::choose::ChoiceRequest;
using measure::evaluate::TestedForm;
using measure::repair::RepairRequest;
using measure::repair::RepairResult;
using output::repair::Proposal;
using output::repair::RepairSummary;

namespace {

/// Repaired forms. They stay loaded as long as this object lives.
struct LoadedRepairs {
    struct LoadedForm {
        intersect::external::Formula formula;
        Format format;
    };
    std::vector<LoadedForm> forms;
    std::vector<output::choose::RepairedCandidate> candidates;  ///< in the same order
};

/// Repairs forms one after another. Deques keep requests and results at fixed addresses.
class FormRepairer {
public:
    FormRepairer(const ChoiceRequest& request, std::string command) : request_(request), command_(std::move(command)) {}

    void repair_all() {
        ChoiceRequest quiet_request = request_;
        quiet_request.progress = [](std::uint64_t) {};
        const auto quality = measure_quality(quiet_request);
        for (std::size_t r = 0; r < request_.tested_forms.size(); ++r)
            if (!quality[r].meets(request_.requirement) && !request_.tested_forms[r].form->has_transform_method)
                repair_one(request_.tested_forms[r]);
    }

    std::vector<measure::repair::RepairedSource> sources = {};
    std::vector<output::choose::RepairedCandidate> candidates = {};

private:
    void repair_one(const TestedForm& tested_form) {
        requests_.push_back({.scene = request_.scene,
                             .tested_form = tested_form,
                             .requirement = request_.requirement,
                             .limit = request_.limit});
        try {
            // 0: do not prove that the sets are minimal, that is, try no smaller sets after the search.
            repairs_.push_back(measure::repair::repair_form(requests_.back(), 0));
        } catch (const InputError&) {
            return;  // its operations are not known, or not the same for every ray
        }
        const RepairSummary result{
            .request = requests_.back(), .repair = repairs_.back(), .catalogue = {}, .catalogue_quality = {}};
        proposals_.push_back(list_proposals(result));
        int count = 0;
        for (const Proposal& proposal : proposals_.back())
            if (proposal.quality->meets(request_.requirement) && is_new(proposal, tested_form))
                add(result, proposal, ++count);
    }

    bool is_new(const Proposal& proposal, const TestedForm& tested_form) {
        const auto lines = output::repair::statements(proposal.tape, *tested_form.form);
        return proposed_codes_
            .insert(fmt::format("{} {} {}", static_cast<int>(tested_form.form->shape), tested_form.format.name,
                                fmt::join(lines, "\n")))
            .second;
    }

    void add(const RepairSummary& result, const Proposal& proposal, int count) {
        const TestedForm& tested_form = result.request.tested_form;
        std::string name(tested_form.form->info->name);
        std::ranges::replace(name, '.', '_');
        name += fmt::format("_{}{}", tested_form.format.name == "f32" ? "" : tested_form.format.name + "_", count);
        sources.push_back(output::repair::make_repaired_source(result, proposal, name, command_));
        std::string description = fmt::format("{}, {}", tested_form.form->info->name, method_text(result, proposal));
        if (proposal.wider_operations) description += ": " + statement_names(result, *proposal.wider_operations);
        candidates.push_back({"mended." + name, std::move(description), *proposal.held_out_quality, name + ".hpp"});
    }

    const ChoiceRequest& request_;
    std::string command_;
    std::deque<RepairRequest> requests_;
    std::deque<RepairResult> repairs_;
    std::deque<std::vector<Proposal>> proposals_;
    std::set<std::string> proposed_codes_;
};

/// Repairs every tested form of the request that does not meet its requirement and whose operations are known. Compiles
/// each repaired form that meets the requirement, and writes it as a file into `folder`. Equal repairs of two forms
/// count once. Throws EnvironmentError if nothing can be compiled. `command` is the command line that asks for the
/// repairs.
LoadedRepairs load_repairs(const ChoiceRequest& request, const measure::repair::CompilerSetup& setup,
                           const std::filesystem::path& folder, const std::string& command) {
    FormRepairer repairer(request, command);
    repairer.repair_all();
    LoadedRepairs repairs;
    if (repairer.sources.empty()) return repairs;
    auto formulas =
        compile_and_load({.scene = request.scene, .tested_form = {}, .limit = request.limit}, repairer.sources, setup);
    for (std::size_t k = 0; k < formulas.size(); ++k) {
        auto& candidate = repairer.candidates[k];
        const auto file = folder / candidate.file;
        output::file::write_file(file, repairer.sources[k].header);
        candidate.file = file.string();
        repairs.forms.push_back({std::move(formulas[k]), repairer.sources[k].original.format});
    }
    repairs.candidates = std::move(repairer.candidates);
    return repairs;
}

struct ChooseOptions : selection::RayFileOptions {
    std::vector<std::string> subjects;  ///< one scene, or files of rays
    std::string size, variant, at = "p99", out;
    std::vector<std::string> forms{"*"}, formats{"f32", "f64"}, set;
    std::string tolerance, unit;
    double bits = -1, wrong = 0;
    std::string compiler = "c++";
    bool single = false, bulk = false, quick = false, mend = false;
};

/// Selects the forms that can be timed on the subject called `id`. `can_test` says which forms can test it.
std::vector<measure::evaluate::TestedForm> select_tested_forms(const ChooseOptions& options, const std::string& id,
                                                               bool quiet, const selection::ShapePredicate& can_test) {
    const auto formats = selection::select_formats(options.formats);
    if (std::ranges::all_of(formats, &Format::is_emulated))
        throw InputError(fmt::format(
            "-f {}: this format is emulated, so its time says nothing; choose compares only f32 and f64. Name one "
            "of them",
            formats.front().name));
    auto candidates = selection::pair_forms_with_formats(selection::select_forms(options.forms), formats);
    selection::require_no_generators(candidates, "choose");
    selection::require_no_contracted_forms(candidates, "choose");
    auto timed_forms = selection::select_timed_forms(id, {candidates, options.forms, quiet}, can_test);
    selection::note_unmeasured(options.forms, timed_forms, quiet);
    return timed_forms;
}

ChoiceRequest make_request(const ChooseOptions& options, intersect::process::StopToken stop) {
    ChoiceRequest request;
    if (options.bits < 0 && options.tolerance.empty())
        throw InputError(
            "choose: the requirement is missing; add --bits 16 (of t) or --tolerance 0.001 (of the hit point)");
    request.requirement = {.bits = std::max(0.0, options.bits),
                           .max_wrong_fraction = options.wrong,
                           .quantile = parse_quantile(options.at)};
    if (!options.tolerance.empty())
        request.requirement.tolerance = selection::tolerance_in_units(options.tolerance, options.unit);
    else if (!options.unit.empty())
        throw InputError("--unit " + options.unit + ": is the unit of --tolerance, which is missing");
    request.times_single_rays = options.single;
    request.limit.stop = request.plan.stop = stop;
    if (options.quick) {
        request.plan.repetitions = 5;
        request.plan.min_seconds = 1e-4;
    }
    return request;
}

using ResultFolderPointer = std::unique_ptr<output::file::ResultFolder>;

/// Chooses a form and writes the results, for a scene or for files of rays. For files, the accuracy on their rays is
/// known already.
ExitStatus choose(ChoiceRequest& request, output::choose::ChoiceWriter& writer,
                  const ResultFolderPointer& result_folder, output::file::Progress& progress,
                  const CommonOptions& common,
                  std::optional<std::vector<output::choose::RepairedCandidate>> repaired = {}) {
    measure::choose::TimedRays timed_rays;
    std::optional<measure::choose::PassingPixelsByForm> passing_pixels;
    if (request.scene) request.show = passing_pixels.emplace(request, request.tested_forms).show();
    const auto measured_candidates = measure_candidates(request, timed_rays);
    auto requirement_map = passing_pixels
                               ? std::optional(make_requirement_map(request, measured_candidates, *passing_pixels))
                               : std::nullopt;

    auto choice = output::choose::choose_among(request, measured_candidates, timed_rays);
    choice.requirement_map = std::move(requirement_map);
    choice.repaired = std::move(repaired);
    if (choice.cheapest_index && request.scene)
        choice.offsets = measure::choose::find_safe_offsets(
            *request.scene, measured_candidates[*choice.cheapest_index].tested_form, request.limit);
    writer.finish(choice);
    complete_folder(result_folder);
    progress.finish();
    fmt::print("{}", output::choose::choice_text(choice));
    if (!common.quiet) fmt::print("{}\n", (writer.folder() / "choose.csv").string());
    return choice.cheapest_index ? ExitStatus::done : ExitStatus::answer_is_no;
}

/// Moves the forms in emulated formats to `untimed_forms`.
void separate_untimed_rows(ChoiceRequest& request) {
    const auto emulated = std::stable_partition(
        request.tested_forms.begin(), request.tested_forms.end(),
        [](const measure::evaluate::TestedForm& tested_form) { return !tested_form.format.is_emulated(); });
    request.untimed_forms.assign(emulated, request.tested_forms.end());
    request.tested_forms.erase(emulated, request.tested_forms.end());
}

ExitStatus choose_for_scene(const ChooseOptions& options, const CommonOptions& common) {
    const auto data = selection::data_folder(common.data);
    const auto scene = selection::load_one_scene(
        {{options.subjects.front()}, options.size, options.variant, options.set, common.stop}, data);
    selection::require_no_generated_rays({scene}, "choose");
    ChoiceRequest request = make_request(options, common.stop);
    request.scene = &scene;
    request.tested_forms =
        select_tested_forms(options, scene.id, common.quiet, [&scene](Shapes forms) { return scene.accepts(forms); });
    separate_untimed_rows(request);

    const auto folder = std::filesystem::path(options.out) / scene.id;
    const auto result_folder = lock_folder(folder, common, selection::scene_arguments(scene, data));
    output::choose::ChoiceWriter writer(folder);
    output::file::Progress progress(scene.pixel_count() * (request.tested_forms.size() + request.untimed_forms.size()),
                                    fmt::format("choose {}", scene.id), common.progress, common.quiet);
    request.progress = advance_callback(progress);
    if (!common.quiet) selection::note_ineffective_settings(options.set, scene.id, request.tested_forms);
    if (!options.mend) return choose(request, writer, result_folder, progress, common);

    // The repaired forms take part in the choice.
    LoadedRepairs repairs = load_repairs(request, {options.compiler, selection::form_flags_folder()}, folder,
                                         common.typed_command.for_subject(selection::scene_arguments(scene, data)));
    for (const auto& repair : repairs.forms)
        request.tested_forms.push_back({.form = &repair.formula.intersector, .format = repair.format});
    return choose(request, writer, result_folder, progress, common, std::move(repairs.candidates));
}

/// Drops the forms in emulated formats, which only the requirement map of a scene shows.
void drop_emulated_rows(ChoiceRequest& request, const std::string& id, bool quiet) {
    const auto emulated =
        std::erase_if(request.tested_forms, [](const auto& tested_form) { return tested_form.format.is_emulated(); });
    if (emulated > 0 && !quiet)
        fmt::print(stderr,
                   "lostbits: {}: for files of rays, only f32 and f64 are compared; emulated formats were left out, "
                   "since they apply only to the requirement map of a scene\n",
                   id);
}

ExitStatus choose_for_files(const ChooseOptions& options, const CommonOptions& common) {
    auto opened_rays = selection::open_rays(options, options.subjects, selection::data_folder(common.data));
    const std::string& id = opened_rays.id;
    const Shapes shapes = opened_rays.shapes;
    ChoiceRequest request = make_request(options, common.stop);
    request.tested_forms =
        select_tested_forms(options, id, common.quiet, [shapes](Shapes forms) { return forms == shapes; });
    drop_emulated_rows(request, id, common.quiet);

    const auto folder = std::filesystem::path(options.out) / id;
    const auto result_folder = lock_folder(folder, common, opened_rays.quoted_files);
    output::choose::ChoiceWriter writer(folder);
    const bool counts_bytes = opened_rays.ray_file->bytes() > 0;
    output::file::Progress progress(counts_bytes ? opened_rays.ray_file->bytes() : 1, fmt::format("choose {}", id),
                                    common.progress, common.quiet);
    const auto advance = advance_callback(progress);
    opened_rays.options.progress = [&](std::uint64_t bytes) { advance(counts_bytes ? bytes : 0); };

    // Reads the files once. What follows uses a sample of their rays.
    const measure::choose::FileRays rays = judge_and_sample(*opened_rays.ray_file, opened_rays.options, request);
    if (!common.quiet) selection::warn_of_rounded_values(rays.typed_file_names, rays.rounded_count, rays.format);
    request.rays = &rays;
    return choose(request, writer, result_folder, progress, common);
}

ExitStatus run(const ChooseOptions& options, const CommonOptions& common) {
    require_folder(options.out);
    const bool is_for_files = selection::are_ray_files(options, options.subjects);
    selection::require_no_misplaced_options(options, options.subjects,
                                            {{"--size", !options.size.empty()},
                                             {"--variant", !options.variant.empty()},
                                             {"--set", !options.set.empty()},
                                             {"--mend", options.mend}},
                                            "a choice");
    const selection::ThreadLimit limit(common.threads);
    return is_for_files ? choose_for_files(options, common) : choose_for_scene(options, common);
}

}  // namespace

void add_choose(const shell::Command& program, const CommonOptions& common) {
    auto command = program.add_command("choose",
                                       "Find the cheapest form and format that meet a requirement on a scene or on the "
                                       "rays of files");
    const auto options = std::make_shared<ChooseOptions>();
    options->stop = common.stop;
    command
        .add("SCENE", options->subjects,
             "A scene file, a name in data/scenes, or files of rays as for `lostbits judge`")
        .required();

    // The requirement.
    command.add("--bits", options->bits,
                "Correct bits of t that a form must keep, for the share of the hits that --at gives",
                shell::number_between(0, 53));
    command.add("--tolerance", options->tolerance,
                "Distance that the hit point may be from the true one, along the ray, in the scene's unit of length");
    command.add("--unit", options->unit, "The scene's unit of length (m, km, cm, mm, um, in, ft), for --tolerance 1mm");
    command.add("--wrong", options->wrong, "Share of the rays that may be decided wrongly (default: 0)",
                shell::number_between(0, 1));
    command.add("--at", options->at,
                "Share of the hits that must meet the requirement: p50, p99 (default), p99.9, or max for all hits");

    // The candidates, and what they cost.
    selection::add_forms(command, options->forms);
    command.add_list(
        "-f,--format", options->formats,
        "f32, f64 (default: both). Emulated formats, such as p16, are not timed; they show the narrowest format "
        "that each pixel needs (docs/choose.md)");
    const auto single = command.add("--single", options->single, "Compare the cost of one ray at a time");
    command
        .add("--bulk", options->bulk,
             "Compare the cost of packs of rays, one ray in each lane of a SIMD register (default)")
        .excludes(single);

    // Changes of the scene, and the meaning of files of rays.
    command.add("--size", options->size, "Picture size, WxH in pixels (default: the scene's)");
    command.add("--variant", options->variant, "One variant of a scene that has several");
    command.add_set(options->set, "Change a number of the scene first: sphere[0].radius=10");
    selection::add_ray_options(command, *options);

    command.add("--mend", options->mend,
                "Also repair the forms that do not meet the requirement, as `lostbits mend` does, and time them");
    command.add("--compiler", options->compiler, "The compiler that --mend uses (default: c++)");
    command.add("--quick", options->quick, "Measure times briefly, for a first look");
    selection::add_out(command, options->out);
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
