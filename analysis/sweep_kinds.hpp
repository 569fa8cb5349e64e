// Shared code of all kinds of `lostbits sweep`, and the kinds that are not over axes: every float, and searches.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/selection/scenes.hpp"
#include "analysis/selection/sweep_options.hpp"
#include "commands.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/metric/metric_set.hpp"
#include "measure/sweep/exhaustive.hpp"
#include "output/shard/state_file.hpp"

namespace lostbits::analysis {

struct SweepOptions : selection::SweepChangeOptions {
    std::vector<std::string> sweeps, forms{"*"};
    std::string out, shard;
    bool worst = false;
    bool resume = false;
};

/// A progress bar with an estimate of the time, which is printed in long runs.
class ProgressWithEstimate {
public:
    /// `done_before`: units of work that the resumed run has done already.
    ProgressWithEstimate(const std::string& id, std::uint64_t units, const CommonOptions& common,
                         std::uint64_t done_before = 0)
        : progress_(units, id, common.progress, common.quiet),
          estimate_(progress_, id, units - done_before, common.quiet) {
        if (done_before > 0) progress_.advance(done_before);
    }
    [[nodiscard]] std::function<void(std::uint64_t)> advance_callback() {
        return analysis::advance_callback(progress_, &estimate_);
    }
    void finish() { progress_.finish(); }

private:
    output::file::Progress progress_;
    output::file::Estimate estimate_;
};

/// The forms, metrics, options and folders of a run of `lostbits sweep`.
struct SweepSelection {
    std::vector<measure::evaluate::TestedForm> tested_forms;
    std::vector<const measure::metric::Metric*> extra_metrics;  ///< metrics in addition to the default ones
    measure::metric::MetricSet& metric_set;
    RunDivision& run_division;
    const SweepOptions& options;
    const CommonOptions& common;

    [[nodiscard]] shard::Division& division() const { return run_division.division; }
    [[nodiscard]] std::filesystem::path data() const { return selection::data_folder(common.data); }
    /// True if no form is named.
    [[nodiscard]] bool takes_all_forms() const { return options.forms == SweepOptions().forms; }
    [[nodiscard]] std::filesystem::path folder_of(const std::string& id) const {
        return std::filesystem::path(options.out) / id;
    }
    /// Locks the folder of a sweep in `out` for this run; null in a shard, which has its own folder.
    [[nodiscard]] std::unique_ptr<output::file::ResultFolder> lock_sweep_folder(
        const std::string& id, const std::filesystem::path& sweep, output::file::ResultFolder::Rules rules = {}) const {
        return lock_folder(run_division, folder_of(id), common, selection::sweep_argument(sweep, data()), rules);
    }
    /// The result of a sweep of `units` units of work, measured here or joined from shards; nothing in a shard.
    template <class Request, class Measure>
    auto measure_or_join(const std::string& id, std::uint64_t units, Request& request, const Measure& measure) const {
        ProgressWithEstimate progress(id, units, common);
        request.progress = progress.advance_callback();
        auto found = division().measure_or_join("sweep " + id, [&] { return measure(request); });
        progress.finish();
        return found;
    }
};

/// Runs a file with a `[search]`, or one with an `[edge_search]`.
void run_search(const std::filesystem::path& path, const SweepSelection& chosen);
void run_edge_search(const std::filesystem::path& path, const SweepSelection& chosen);

/// A sweep over every float, which can be stopped and resumed. Not movable: the request points into it.
class ExhaustiveRun {
public:
    /// Takes the forms that can test the sweep, in f32. Throws InputError for a file that is not such a sweep.
    ExhaustiveRun(const std::filesystem::path& path, const SweepSelection& chosen);
    ExhaustiveRun(const ExhaustiveRun&) = delete;
    ExhaustiveRun& operator=(const ExhaustiveRun&) = delete;

    [[nodiscard]] bool was_stopped() const { return state_file_.exists(); }
    /// Reads the state of a stopped run. Throws InputError if no run was stopped here, or if it belongs to another run.
    void read_saved_state();
    /// Tries the floats that are left and writes the results, or records them in a shard. Keeps its state if it is
    /// stopped, or if others follow. Returns the number of truths that were not proved.
    std::uint64_t run(bool others_follow);
    /// Removes the state, after the results are kept elsewhere.
    void forget_state() const;

private:
    measure::sweep::ExhaustiveState try_floats(bool keeps_state);

    scene::sweep::ExhaustiveFile sweep_;
    measure::sweep::ExhaustiveRequest request_{.sweep = sweep_};
    measure::sweep::ExhaustiveState state_;
    std::filesystem::path path_, folder_;
    output::shard::UnfinishedFile state_file_;
    bool is_resumed_ = false;
    const SweepSelection& chosen_;
};

}  // namespace lostbits::analysis
