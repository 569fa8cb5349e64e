// `lostbits merge`: the command whose shards lie there runs once more, with everything measured.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/shard/division.hpp"
#include "number/error.hpp"

namespace lostbits::analysis::shard {

/// Runs the command of these words, of which the shards have measured everything.
using RunOfShards = std::function<Exit(std::vector<std::string> words, std::shared_ptr<Shards> shards)>;

/// Registers the subcommand and stores in `chosen` what to run when it was given; `version` is the program's.
void add_merge(CLI::App& program, std::function<Exit()>& chosen, const std::string& version,
               const RunOfShards& run_again);

}  // namespace lostbits::analysis::shard
