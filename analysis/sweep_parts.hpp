// What the kinds of `lostbits sweep` have in common.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/choice/sweep_options.hpp"
#include "commands.hpp"
#include "measure/map/map.hpp"
#include "measure/metric/metric_set.hpp"
#include "output/file/estimate.hpp"

namespace lostbits::analysis {

struct SweepOptions {
    std::vector<std::string> sweeps;
    std::vector<std::string> forms{"*"};
    std::vector<std::string> formats;
    std::vector<std::string> metrics;
    std::string out, against, shard;
    choice::SweepWords changes;
    bool worst = false;
    bool resume = false;
    std::optional<int> seeds;
};

/// Moves a bar on, and says on long runs how long they will take.
class Watched {
public:
    Watched(const std::string& id, std::uint64_t units, const Common& common)
        : progress_(units, id, common.progress, common.quiet), estimate_(progress_, id, units, common.quiet) {}
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

struct Chosen {
    std::vector<measure::map::MapRow> rows;
    std::vector<const measure::metric::Metric*> asked;  ///< metrics beside the default ones
    measure::metric::MetricSet& made;
    Divided& divided;

    [[nodiscard]] shard::Division& division() const { return divided.division; }
    /// The folder of a sweep in `out`, the run's own; a shard has one already.
    [[nodiscard]] std::unique_ptr<output::file::ResultFolder> own(const std::filesystem::path& folder,
                                                                  const std::filesystem::path& sweep,
                                                                  const Common& common) const {
        if (divided.division.is_shard()) return nullptr;
        return own_folder(folder, common, choice::name_of_sweep(sweep, choice::data_folder(common.data)));
    }
};

/// Of a file with a `[search]`, and of one with an `[edge_search]`.
void run_search(const std::filesystem::path& path, const Chosen& chosen, const SweepOptions& o, const Common& common);
void run_edge_search(const std::filesystem::path& path, const Chosen& chosen, const SweepOptions& o,
                     const Common& common);

}  // namespace lostbits::analysis
