// `lostbits sweep` over every float of an axis.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "measure/sweep/exhaustive.hpp"
#include "output/sweep/exhaustive_state_file.hpp"

namespace lostbits::analysis {

/// A run that may be stopped and resumed. Not movable: the request points into it.
class ExhaustiveRun {
public:
    /// Of the forms of the rows that can meet the sweep, in f32. InputError for a file that is not such a sweep and,
    /// where the run is to be resumed, for a state that it cannot go on from.
    ExhaustiveRun(const std::filesystem::path& path, const std::filesystem::path& data,
                  const std::vector<measure::map::MapRow>& rows, const std::filesystem::path& out, bool resume,
                  shard::Division& division);
    ExhaustiveRun(const ExhaustiveRun&) = delete;
    ExhaustiveRun& operator=(const ExhaustiveRun&) = delete;

    /// Tries what is left and writes the results, or notes them in a shard; when it is stopped, the state. Returns how
    /// many truths were not proved.
    std::uint64_t run(const Common& common);
    /// Takes the state away: what was found is kept elsewhere.
    void forget_state() const;

private:
    void try_or_join(const Common& common);
    void try_all(const Common& common);
    void note_older_state(const Common& common) const;

    scene::sweep::ExhaustiveFile sweep_;
    measure::sweep::ExhaustiveRequest request_;
    measure::sweep::ExhaustiveState state_;
    output::sweep::RunIdentity identity_;
    std::filesystem::path path_, folder_, state_file_;
    bool resumed_;
    shard::Division& division_;
};

/// Options of `lostbits sweep`; what was not given is empty.
struct SweepWishes {
    const std::vector<std::string>&formats, &metrics;
    std::optional<int> seeds;
};
/// InputError where they ask of such a sweep what it does not do: formats beside f32, metrics, further draws.
void check_exhaustive_options(const std::string& sweep, const SweepWishes& wishes);

}  // namespace lostbits::analysis
