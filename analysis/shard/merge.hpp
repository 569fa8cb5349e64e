// `lostbits merge`: the command whose shards lie there runs once more, with everything measured.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/shard/division.hpp"
#include "analysis/shell/command_line.hpp"
#include "number/error.hpp"

namespace lostbits::analysis::shard {

/// Runs the command of these words, of which the shards have measured everything.
using RunOfShards = std::function<Exit(std::vector<std::string> words, std::shared_ptr<Shards> shards)>;

/// Registers the subcommand; `version` is the program's.
void add_merge(const shell::Command& program, const std::string& version, const RunOfShards& run_again);

}  // namespace lostbits::analysis::shard
