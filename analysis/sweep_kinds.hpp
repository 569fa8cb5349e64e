// What the kinds of `lostbits sweep` have in common, and those that are not over axes: every float, and searches.
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

struct SweepOptions : selection::SweepWords {
    std::vector<std::string> sweeps, forms{"*"};
    std::string out, shard;
    bool worst = false;
    bool resume = false;
};

/// Moves a bar on, and says on long runs how long they will take.
class Watched {
public:
    /// `done`: units of an earlier run, which this one goes on with.
    Watched(const std::string& id, std::uint64_t units, const Common& common, std::uint64_t done = 0)
        : progress_(units, id, common.progress, common.quiet), estimate_(progress_, id, units - done, common.quiet) {
        if (done > 0) progress_.advance(done);
    }
    [[nodiscard]] std::function<void(std::uint64_t)> advancing() { return analysis::advancing(progress_, &estimate_); }
    void finish() { progress_.finish(); }

private:
    output::file::Progress progress_;
    output::file::Estimate estimate_;
};

struct ChosenOfSweep {
    std::vector<measure::evaluate::TestedForm> rows;
    std::vector<const measure::metric::Metric*> asked;  ///< metrics beside the default ones
    measure::metric::MetricSet& made;
    Divided& divided;
    const SweepOptions& o;
    const Common& common;

    [[nodiscard]] shard::Division& division() const { return divided.division; }
    [[nodiscard]] std::filesystem::path data() const { return selection::data_folder(common.data); }
    [[nodiscard]] std::filesystem::path folder_of(const std::string& id) const {
        return std::filesystem::path(o.out) / id;
    }
    /// The folder of a sweep in `out`, the run's own; a shard has one already.
    [[nodiscard]] std::unique_ptr<output::file::ResultFolder> own(const std::string& id,
                                                                  const std::filesystem::path& sweep,
                                                                  output::file::ResultFolder::Rules rules = {}) const {
        if (divided.division.is_shard()) return nullptr;
        return own_folder(folder_of(id), common, selection::name_of_sweep(sweep, data()), rules);
    }
    /// What a sweep of so many units comes to, measured here or joined from shards; nothing in a shard.
    template <class Request, class Measure>
    auto measured(const std::string& id, std::uint64_t units, Request& request, const Measure& measure) const {
        Watched progress(id, units, common);
        request.progress = progress.advancing();
        auto found = division().result_of("sweep " + id, [&] { return measure(request); });
        progress.finish();
        return found;
    }
};

/// Of a file with a `[search]`, and of one with an `[edge_search]`.
void run_search(const std::filesystem::path& path, const ChosenOfSweep& chosen);
void run_edge_search(const std::filesystem::path& path, const ChosenOfSweep& chosen);

/// A run that may be stopped and resumed. Not movable: the request points into it.
class ExhaustiveRun {
public:
    /// Of the forms of the rows that can meet the sweep, in f32. InputError for a file that is not such a sweep.
    ExhaustiveRun(const std::filesystem::path& path, const ChosenOfSweep& chosen);
    ExhaustiveRun(const ExhaustiveRun&) = delete;
    ExhaustiveRun& operator=(const ExhaustiveRun&) = delete;

    [[nodiscard]] bool was_stopped() const { return unfinished_.is_there(); }
    /// InputError where there is no state, or one that it cannot go on from.
    void resume();
    /// Tries what is left and writes the results, or notes them in a shard; when it is stopped, or others follow, the
    /// state. Returns how many truths were not proved.
    std::uint64_t run(bool others_follow);
    /// Takes the state away: what was found is kept elsewhere.
    void forget_state() const;

private:
    measure::sweep::ExhaustiveState try_all(bool keep);

    scene::sweep::ExhaustiveFile sweep_;
    measure::sweep::ExhaustiveRequest request_{.sweep = sweep_};
    measure::sweep::ExhaustiveState state_;
    std::filesystem::path path_, folder_;
    output::shard::UnfinishedFile unfinished_;
    bool resumed_ = false;
    const ChosenOfSweep& chosen_;
};

}  // namespace lostbits::analysis
