// How far an exhaustive sweep came before it was stopped: the file that it goes on from.
#pragma once

#include <filesystem>
#include <string>

#include "measure/sweep/exhaustive.hpp"

namespace lostbits::output::sweep {

/// In the folder of the sweep's results, while the sweep is not finished.
inline constexpr const char* state_file_name = "unfinished.state";

/// What a state is of: a run with anything else may not go on from it.
struct RunIdentity {
    std::string version;  ///< of the program
    std::uint64_t sweep_hash = 0;
    std::string forms;  ///< with a space between them
    measure::shard::Share share = {};
};
RunIdentity identity_of(const measure::sweep::ExhaustiveRequest& request, const std::string& version);

/// What a run has tried and found, as text.
std::string state_text(const measure::sweep::ExhaustiveState& state);

/// The same from that text. InputError, the path in front, where it is damaged.
measure::sweep::ExhaustiveState state_in(const std::string& text, const std::filesystem::path& path,
                                         const measure::sweep::ExhaustiveRequest& request);

/// Written whole or not at all.
void write_state(const std::filesystem::path& path, const RunIdentity& identity,
                 const measure::sweep::ExhaustiveState& state);

/// InputError where there is no such file, where it is of another run (it says what differs), or where it is damaged.
measure::sweep::ExhaustiveState read_state(const std::filesystem::path& path, const RunIdentity& identity,
                                           const measure::sweep::ExhaustiveRequest& request);

}  // namespace lostbits::output::sweep
