#include "sweep_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "analysis/selection/select.hpp"
#include "analysis/selection/sweep_options.hpp"
#include "measure/edges/edge_search.hpp"
#include "measure/tape/contraction.hpp"
#include "measure/tape/tape_form.hpp"
#include "output/shard/fields.hpp"
#include "output/sweep/exhaustive_files.hpp"
#include "output/sweep/worst_files.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::analysis {

using measure::answer::Outcome;
using measure::evaluate::TestedForm;
using measure::sweep::ExhaustiveState;

namespace {

constexpr auto save_interval = std::chrono::seconds(5);

/// The fraction in percent, rounded down, so that a stopped run is never 100 % done.
std::uint64_t percent(std::uint64_t part, std::uint64_t whole) {
    return static_cast<std::uint64_t>(static_cast<double>(part) / static_cast<double>(whole) * 100);
}

}  // namespace

ExhaustiveRun::ExhaustiveRun(const std::filesystem::path& path, const SweepSelection& chosen)
    : sweep_(path, chosen.data()),
      path_(path),
      folder_(chosen.folder_of(sweep_.id)),
      state_file_(folder_,
                  {.program = program_and_version,
                   .command = chosen.common.typed_command.for_subject(selection::sweep_argument(path, chosen.data())),
                   .inputs = hash_inputs(selection::list_input_files(path, scene::sweep::SweepKind::every_float,
                                                                     chosen.options, chosen.data(), chosen.common.stop),
                                         chosen.common),
                   .share = chosen.division().share()},
                  "sweep " + sweep_.id),
      chosen_(chosen) {
    request_.share = chosen.division().share();
    request_.limit.stop = chosen.common.stop;
    if (sweep_.scene) request_.scene = selection::scene_arguments(*sweep_.scene, chosen.data());
    for (TestedForm tested_form :
         selection::filter_tested_forms(chosen.tested_forms, [&](Shapes forms) { return sweep_.accepts(forms); })) {
        if (tested_form.format.engine != Format::Engine::native32) continue;
        tested_form.touching = sweep_.convention;
        request_.tested_forms.push_back(tested_form);
    }
}

void ExhaustiveRun::read_saved_state() {
    state_file_.read([this](output::shard::BitReader& bits) {
        bits(state_);
        state_.require_match(request_);
    });
    is_resumed_ = true;
}

ExhaustiveState ExhaustiveRun::try_floats(bool keeps_state) {
    require_writable(state_file_.path());
    const std::uint64_t rays_per_float = sweep_.rays.size() * request_.tested_forms.size();
    const std::uint64_t float_count = measure::sweep::count_floats(sweep_, request_.share);
    ProgressWithEstimate progress(sweep_.id, float_count * rays_per_float, chosen_.common,
                                  state_.tried_float_count * rays_per_float);
    request_.progress = progress.advance_callback();

    // A run that is killed loses at most the work of a few seconds.
    auto last_save = std::chrono::steady_clock::now();
    request_.store_state = [&](const ExhaustiveState& state) {
        if (std::chrono::steady_clock::now() - last_save < save_interval) return;
        state_file_.write(output::shard::bits_of(state));
        last_save = std::chrono::steady_clock::now();
    };

    try {
        measure::sweep::run_exhaustive(request_, state_);
    } catch (const Interrupted&) {
        progress.finish();
        state_file_.write(output::shard::bits_of(state_));
        if (!chosen_.common.quiet)
            fmt::print(stderr, "lostbits: {} was stopped at {} %; repeat the command with --resume to continue\n",
                       sweep_.id, percent(state_.tried_float_count, float_count));
        throw Error(ExitStatus::interrupted,
                    selection::interrupted_text(scene::sweep::SweepKind::every_float, sweep_.id));
    }
    progress.finish();
    if (keeps_state) state_file_.write(output::shard::bits_of(state_));
    return std::move(state_);
}

void ExhaustiveRun::forget_state() const {
    const auto result_folder =
        was_stopped() ? chosen_.lock_sweep_folder(sweep_.id, path_, {.continues_run = true}) : nullptr;
    output::file::remove_result(state_file_.path());
    std::error_code ignored;
    std::filesystem::remove(folder_, ignored);  // only removes an empty folder, as a shard leaves it
}

std::uint64_t ExhaustiveRun::run(bool others_follow) {
    const CommonOptions& common = chosen_.common;
    // The user may have forgotten --resume. The old state stays until this run writes its own.
    if (!is_resumed_ && !common.quiet && state_file_.exists())
        fmt::print(stderr,
                   "lostbits: {} is the state of a stopped run; this run starts from the beginning (to continue that "
                   "one, use --resume)\n",
                   state_file_.path().string());

    const auto result_folder = chosen_.lock_sweep_folder(
        sweep_.id, path_, {.continues_run = is_resumed_, .can_resume = !common.shards_to_join});
    std::optional<output::sweep::ExhaustiveWriter> writer;
    if (result_folder) writer.emplace(request_, folder_);
    const auto state = chosen_.division().measure_or_join(
        "sweep " + sweep_.id, [&] { return try_floats(others_follow); },
        [this](const ExhaustiveState& part) { part.require_match(request_); });
    if (!state) return 0;

    // The state of a stopped run was joined as if it were a shard: floats are missing, so no statement would be true.
    if (const std::uint64_t float_count = measure::sweep::count_floats(sweep_, {});
        state->tried_float_count != float_count)
        throw InputError(fmt::format(
            "only {} of the {} floats of {} were tried: one of the shards was stopped; run that shard again with "
            "--resume, then join the shards",
            state->tried_float_count, float_count, sweep_.id));

    const auto findings = measure::sweep::collect_findings(request_, *state);
    writer->finish(*state, findings);
    if (!others_follow) output::file::remove_result(state_file_.path());
    complete_folder(result_folder);

    std::uint64_t unresolved = 0;
    for (const auto& finding : findings) unresolved += finding.tally.count(Outcome::unresolved);
    if (common.quiet) return unresolved;
    fmt::print("{}\n", (folder_ / "binades.csv").string());
    for (const auto& finding : findings) fmt::print("{}\n", output::sweep::statement(request_, finding));
    if (common.verbose) print_stages(state->stages);
    return unresolved;
}

namespace {

/// For a message: the keys of a search that may leave no ray, and what to write instead.
std::string excluding_keys_text(const scene::sweep::SearchFile& search) {
    if (search.aim)
        return "distance may put every origin outside the range of origin; widen origin, or narrow distance";
    if (search.at_edge) return "rays to the edges of the boxes may all start outside the range of origin; widen origin";
    if (search.is_round())
        return "distance_radii and impact_radii may exclude every ray of the other ranges; widen one of them";
    return "the ranges may contain no valid primitive, or none that a ray of the ranges meets; change the ranges";
}

}  // namespace

void run_search(const std::filesystem::path& path, const SweepSelection& chosen) {
    scene::sweep::SearchFile search(path, selection::read_changes(chosen.options).set);
    search.title += chosen.options.title_suffix();
    measure::sweep::WorstRequest request{.search = search,
                                         .tested_forms = selection::filter_tested_forms(
                                             chosen.tested_forms, [&](Shapes forms) { return forms == search.shape; }),
                                         .metrics = {},
                                         .limit = {.stop = chosen.common.stop}};
    Primitive<double> example;  // labels do not depend on its numbers
    example.shape = search.shape;
    request.metrics = chosen.metric_set.adapt_to_forms(
        selection::with_default_metrics({chosen.metric_set.find(search.metric)}, request.tested_forms),
        measure::evaluate::forms_of(request.tested_forms), measure::attribution::Setting{std::span(&example, 1)});

    const auto folder = chosen.folder_of(search.id);
    const auto result_folder = chosen.lock_sweep_folder(search.id, path);
    if (result_folder) require_writable(folder / "worst.csv");
    request.share = chosen.division().share();
    const auto worst_rays = chosen.measure_or_join(
        search.id, request.share.unit_range(request.tested_forms.size()).size(), request, measure::sweep::find_worst);
    if (!worst_rays) return;

    if (std::ranges::none_of(*worst_rays, [](const auto& w) { return w.has_value(); })) {
        throw NothingSelected(path.string() + ": no form hit anything with a ray of these ranges; " +
                              excluding_keys_text(search));
    }
    output::sweep::write_worst(folder, request, *worst_rays);
    complete_folder(result_folder);
    if (!chosen.common.quiet) fmt::print("{}\n", (folder / "worst.csv").string());
}

namespace {

/// Adds, after each form, the form as a compiler contracts it. Contraction makes some watertight tests leak.
void add_contracted(std::vector<TestedForm>& tested_forms) {
    std::vector<TestedForm> all;
    for (const TestedForm& tested_form : tested_forms) {
        all.push_back(tested_form);
        if (!measure::tape::has_tape(*tested_form.form)) continue;
        const auto& contracted = measure::tape::contract_form(*tested_form.form);
        if (contracted.exists_in(tested_form.format)) all.push_back({&contracted, tested_form.format});
    }
    tested_forms = std::move(all);
}

}  // namespace

void run_edge_search(const std::filesystem::path& path, const SweepSelection& chosen) {
    scene::sweep::EdgeSearchFile search(path, chosen.data(), selection::read_changes(chosen.options).set,
                                        chosen.common.stop);
    search.title += chosen.options.title_suffix();
    measure::edges::EdgeRequest request{.search = search,
                                        .tested_forms = selection::filter_tested_forms(
                                            chosen.tested_forms, [&](Shapes forms) { return search.accepts(forms); }),
                                        .limit = {.stop = chosen.common.stop}};
    if (chosen.takes_all_forms()) add_contracted(request.tested_forms);
    for (const TestedForm& tested_form : request.tested_forms)
        if (scene::rays::generator_of(*tested_form.form) != nullptr)
            throw InputError(std::string(tested_form.form->info->name) + ": the rays of " + search.id +
                             " are not made by a camera; name the form without @ray-");

    const auto folder = chosen.folder_of(search.id);
    const auto result_folder = chosen.lock_sweep_folder(search.id, path);
    if (result_folder) require_writable(folder / "worst.csv");
    request.share = chosen.division().share();
    const auto units =
        measure::edges::progress_units_per_form * request.share.unit_range(request.tested_forms.size()).size();
    const auto edge_results = chosen.measure_or_join(search.id, units, request, measure::edges::search_edges);
    if (!edge_results) return;

    const output::sweep::NearestWriter writer{request, *edge_results,
                                              selection::scene_arguments(search.scene, chosen.data())};
    writer.write(folder);
    complete_folder(result_folder);
    if (chosen.common.quiet) return;
    fmt::print("{}\n{}\n", (folder / "census.csv").string(), (folder / "worst.csv").string());
    for (std::size_t r = 0; r < edge_results->size(); ++r) fmt::print("{}\n", writer.sentence(r));
}

}  // namespace lostbits::analysis
