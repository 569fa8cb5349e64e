// What the kinds of `lostbits sweep` have in common, and those that are not over axes: every float, and searches.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/scenes.hpp"
#include "analysis/selection/sweep_options.hpp"
#include "commands.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/metric/metric_set.hpp"
#include "measure/sweep/exhaustive.hpp"
#include "output/file/progress.hpp"
#include "output/shard/state_file.hpp"

namespace lostbits::analysis {

struct SweepOptions {
    std::vector<std::string> sweeps;
    std::vector<std::string> forms{"*"};
    std::vector<std::string> formats;
    std::vector<std::string> metrics;
    std::string out, against, shard;
    selection::SweepWords changes;
    bool worst = false;
    bool resume = false;
    std::optional<int> seeds;
};

/// Moves a bar on, and says on long runs how long they will take.
class Watched {
public:
    /// `done`: units of an earlier run, which this one goes on with.
    Watched(const std::string& id, std::uint64_t units, const Common& common, std::uint64_t done = 0)
        : progress_(units, id, common.progress, common.quiet), estimate_(progress_, id, units - done, common.quiet) {
        if (done > 0) progress_.advance(done);
    }
    [[nodiscard]] std::function<void(std::uint64_t)> advancing() {
        return [this, move = analysis::advancing(progress_)](std::uint64_t done) {
            estimate_.advance(done);
            move(done);
        };
    }
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

    [[nodiscard]] shard::Division& division() const { return divided.division; }
    /// The folder of a sweep in `out`, the run's own; a shard has one already.
    [[nodiscard]] std::unique_ptr<output::file::ResultFolder> own(const std::filesystem::path& folder,
                                                                  const std::filesystem::path& sweep,
                                                                  const Common& common, bool keep = false) const {
        if (divided.division.is_shard()) return nullptr;
        return own_folder(folder, common, selection::name_of_sweep(sweep, selection::data_folder(common.data)),
                          {.keep = keep});
    }
};

/// Of a file with a `[search]`, and of one with an `[edge_search]`.
void run_search(const std::filesystem::path& path, const ChosenOfSweep& chosen, const SweepOptions& o,
                const Common& common);
void run_edge_search(const std::filesystem::path& path, const ChosenOfSweep& chosen, const SweepOptions& o,
                     const Common& common);

/// A run that may be stopped and resumed. Not movable: the request points into it.
class ExhaustiveRun {
public:
    /// Of the forms of the rows that can meet the sweep, in f32. InputError for a file that is not such a sweep.
    ExhaustiveRun(const std::filesystem::path& path, const std::filesystem::path& data, const ChosenOfSweep& chosen,
                  const SweepOptions& o, const Common& common);
    ExhaustiveRun(const ExhaustiveRun&) = delete;
    ExhaustiveRun& operator=(const ExhaustiveRun&) = delete;

    [[nodiscard]] bool was_stopped() const { return unfinished_.is_there(); }
    /// InputError where there is no state, or one that it cannot go on from.
    void resume();
    /// Tries what is left and writes the results, or notes them in a shard; when it is stopped, the state. Returns how
    /// many truths were not proved.
    std::uint64_t run();
    /// Takes the state away: what was found is kept elsewhere.
    void forget_state() const;

private:
    measure::sweep::ExhaustiveState try_all();

    scene::sweep::ExhaustiveFile sweep_;
    measure::sweep::ExhaustiveRequest request_;
    measure::sweep::ExhaustiveState state_;
    std::filesystem::path path_, folder_;
    std::string job_;
    output::shard::UnfinishedFile unfinished_;
    bool resumed_ = false;
    const ChosenOfSweep& chosen_;
    const Common& common_;
};

/// InputError where the options ask of such a sweep what it does not do: formats beside f32, metrics, further draws,
/// another form to compare with.
void check_exhaustive_options(const std::string& sweep, const SweepOptions& o);

}  // namespace lostbits::analysis
