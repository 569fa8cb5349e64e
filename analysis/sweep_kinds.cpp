#include "sweep_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "analysis/selection/select.hpp"
#include "analysis/selection/sweep_options.hpp"
#include "measure/edges/nearest.hpp"
#include "output/edges/nearest_files.hpp"
#include "output/file/estimate.hpp"
#include "output/sweep/exhaustive_files.hpp"
#include "output/sweep/exhaustive_text.hpp"
#include "output/sweep/worst_files.hpp"
#include "scene/rays/made_rows.hpp"

namespace lostbits::analysis {

using measure::answer::Outcome;
using measure::evaluate::TestedForm;
using measure::sweep::ExhaustiveState;
using output::file::Progress;

namespace {

constexpr auto keep_every = std::chrono::seconds(5);

/// Rounded down: a run that is stopped is never 100 % done.
std::uint64_t percent(std::uint64_t part, std::uint64_t whole) {
    return static_cast<std::uint64_t>(static_cast<double>(part) / static_cast<double>(whole) * 100);
}

}  // namespace

ExhaustiveRun::ExhaustiveRun(const std::filesystem::path& path, const std::filesystem::path& data,
                             const std::vector<TestedForm>& rows, const std::filesystem::path& out, bool resume,
                             shard::Division& division)
    : sweep_(path, data),
      path_(path),
      folder_(out / sweep_.id),
      state_file_(folder_ / output::sweep::state_file_name),
      resumed_(resume),
      division_(division) {
    request_.sweep = &sweep_;
    request_.share = division.share();
    if (sweep_.scene) request_.scene = selection::name_of_scene(*sweep_.scene, data);
    for (TestedForm row : selection::fitting(rows, [&](Shapes forms) { return sweep_.meets(forms); })) {
        if (row.format.engine != Format::Engine::native32) continue;
        row.judged = sweep_.convention;
        request_.rows.push_back(row);
    }
    identity_ = output::sweep::identity_of(request_, LOSTBITS_VERSION);
    if (resume) state_ = output::sweep::read_state(state_file_, identity_, request_);
}

/// Someone may have forgotten --resume; the state is there until this run keeps its own.
void ExhaustiveRun::note_older_state(const Common& common) const {
    if (resumed_ || common.quiet || !std::filesystem::exists(state_file_)) return;
    fmt::print(stderr, "lostbits: {} is there from a run that was stopped; this one begins anew (--resume goes on)\n",
               state_file_.string());
}

void ExhaustiveRun::try_all(const Common& common) {
    const std::uint64_t each = sweep_.rays.size() * request_.rows.size();
    const std::uint64_t floats = measure::sweep::floats_of(sweep_, request_.share);
    Progress progress(floats * each, sweep_.id, common.progress, common.quiet);
    progress.advance(state_.tried * each);
    output::file::Estimate estimate(progress, sweep_.id, (floats - state_.tried) * each, common.quiet);
    request_.progress = [&estimate, move = advancing(progress)](std::uint64_t done) {
        estimate.advance(done);
        move(done);
    };
    request_.limit.stop = common.stop;
    auto kept = std::chrono::steady_clock::now();
    request_.keep = [&](const ExhaustiveState& state) {
        if (std::chrono::steady_clock::now() - kept < keep_every) return;
        output::sweep::write_state(state_file_, identity_, state);
        kept = std::chrono::steady_clock::now();
    };
    try {
        measure::sweep::run_exhaustive(request_, state_);
    } catch (const Interrupted&) {
        progress.finish();
        output::sweep::write_state(state_file_, identity_, state_);
        if (!common.quiet)
            fmt::print(stderr, "lostbits: {} was stopped at {} %; the same command with --resume goes on from there\n",
                       sweep_.id, percent(state_.tried, floats));
        throw Error(Exit::interrupted, selection::interrupted_text(scene::sweep::SweepKind::every_float, sweep_.id));
    }
    progress.finish();
}

void ExhaustiveRun::try_or_join(const Common& common) {
    const std::string job = "sweep " + sweep_.id;
    if (division_.joins()) {
        division_.each(job, [this](output::shard::BitReader& bits) {
            std::string text;
            bits(text);
            state_.append(output::sweep::state_in(text, state_file_, request_));
        });
        return;
    }
    probe(state_file_);
    try_all(common);
    if (division_.is_shard()) division_.put(job, output::sweep::state_text(state_));
}

void ExhaustiveRun::forget_state() const {
    output::file::forget_result(state_file_);
    std::error_code ignored;
    if (division_.is_shard()) std::filesystem::remove(folder_, ignored);  // it held nothing else
}

std::uint64_t ExhaustiveRun::run(const Common& common) {
    note_older_state(common);
    if (division_.is_shard()) {
        try_or_join(common);
        return 0;
    }
    const auto owner = own_folder(folder_, common, selection::name_of_sweep(path_, selection::data_folder(common.data)),
                                  {.keep = resumed_});
    output::sweep::ExhaustiveFiles files(request_, folder_);
    try_or_join(common);
    const auto findings = measure::sweep::findings_of(request_, state_);
    files.finish(state_, findings);
    forget_state();
    std::uint64_t unresolved = 0;
    for (const auto& finding : findings) unresolved += finding.tally.count(Outcome::unresolved);
    if (common.quiet) return unresolved;
    fmt::print("{}\n", (folder_ / "binades.csv").string());
    for (const auto& finding : findings) fmt::print("{}\n", output::sweep::statement(request_, finding));
    if (common.verbose) print_stages(state_.stages);
    return unresolved;
}

void check_exhaustive_options(const std::string& sweep, const SweepWishes& wishes) {
    const auto& [formats, metrics, seeds] = wishes;
    const auto other = std::ranges::find_if(formats, [](const std::string& name) { return name != "f32"; });
    if (other != formats.end())
        throw InputError(
            fmt::format("-f {}: {} tries every number of one format, and that is f32; leave out -f", *other, sweep));
    if (!metrics.empty())
        throw InputError(
            fmt::format("--metric {}: {} tries every float and measures outcomes and ulp errors alone; "
                        "leave out --metric, and ask `lostbits explain` about single floats",
                        metrics.front(), sweep));
    if (seeds)
        throw InputError(fmt::format("--seeds {}: {} tries every float and draws nothing at random; leave out --seeds",
                                     *seeds, sweep));
}

void run_search(const std::filesystem::path& path, const ChosenOfSweep& chosen, const SweepOptions& o,
                const Common& common) {
    scene::sweep::SearchFile search(path, selection::read_changes(o.changes).set);
    search.title += o.changes.in_title();
    measure::sweep::WorstRequest request{
        .search = search,
        .rows = selection::fitting(chosen.rows, [&](Shapes forms) { return forms == search.shape; }),
        .metrics = {},
        .limit = {.stop = common.stop}};
    Solid<double> any;  // labels do not depend on its numbers
    any.shape = search.shape;
    request.metrics =
        chosen.made.for_forms(selection::measured({chosen.made.find(search.metric)}, request.rows),
                              measure::evaluate::forms_of(request.rows), measure::blame::Setting{std::span(&any, 1)});
    const auto folder = std::filesystem::path(o.out) / search.id;
    const auto owner = chosen.own(folder, path, common);
    if (owner) probe(folder / "worst.csv");
    request.share = chosen.division().share();
    Watched progress(search.id, request.share.of_units(request.rows.size()).size(), common);
    request.progress = progress.advancing();
    const auto found =
        chosen.division().result_of("sweep " + search.id, [&request] { return measure::sweep::find_worst(request); });
    progress.finish();
    if (!found) return;
    if (std::ranges::none_of(*found, [](const auto& w) { return w.has_value(); })) {
        throw NothingSelected(path.string() +
                              ": no form hit anything with a ray of these ranges; distance_radii and impact_radii may "
                              "exclude all of the other ranges");
    }
    output::sweep::write_worst(folder, request, *found);
    if (!common.quiet) fmt::print("{}\n", (folder / "worst.csv").string());
}

void run_edge_search(const std::filesystem::path& path, const ChosenOfSweep& chosen, const SweepOptions& o,
                     const Common& common) {
    const auto data = selection::data_folder(common.data);
    scene::sweep::EdgeSearchFile search(path, data, selection::read_changes(o.changes).set);
    search.title += o.changes.in_title();
    measure::edges::EdgeRequest request{
        .search = search,
        .rows = selection::fitting(chosen.rows, [&](Shapes forms) { return search.meets(forms); }),
        .limit = {.stop = common.stop}};
    for (const TestedForm& row : request.rows)
        if (scene::rays::maker_of(*row.form) != nullptr)
            throw InputError(std::string(row.form->info->name) + ": the rays of " + search.id +
                             " are not those of a camera; name the form without @ray-");
    const auto folder = std::filesystem::path(o.out) / search.id;
    const auto owner = chosen.own(folder, path, common);
    if (owner) probe(folder / "worst.csv");
    request.share = chosen.division().share();
    Watched progress(search.id, measure::edges::sought.size() * request.share.of_units(request.rows.size()).size(),
                     common);
    request.progress = progress.advancing();
    const auto found =
        chosen.division().result_of("sweep " + search.id, [&request] { return measure::edges::find_nearest(request); });
    progress.finish();
    if (!found) return;
    const output::edges::NearestFiles files{request, *found, selection::name_of_scene(search.scene, data)};
    files.write(folder);
    if (common.quiet) return;
    fmt::print("{}\n", (folder / "worst.csv").string());
    for (std::size_t r = 0; r < found->size(); ++r) fmt::print("{}\n", files.sentence(r));
}

}  // namespace lostbits::analysis
