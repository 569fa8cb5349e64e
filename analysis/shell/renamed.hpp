// Options that had another name: the old one is read, with a line of advice.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::shell {

struct RenamedOption {
    const char* command;  ///< "*" for every command
    const char* before;
    const char* now;  ///< an option, or the name of an argument
};
/// All of them; CHANGELOG.md has the same table.
std::span<const RenamedOption> renamed_options();

/// Words with the names of today, and a sentence for each old name that was read.
struct UpdatedArguments {
    std::vector<std::string> words, advice;
};
UpdatedArguments with_new_names(const Command& program, const std::vector<std::string>& words);

}  // namespace lostbits::analysis::shell
