// Old names of options. They still work, and a line of advice gives the new name.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::shell {

struct RenamedOption {
    const char* command;  ///< "*" for every command
    const char* old_name;
    const char* new_name;  ///< an option, or the name of an argument
};
/// All renamed options; CHANGELOG.md has the same table.
std::span<const RenamedOption> renamed_options();

/// Arguments with the present names of options, and a sentence of advice for each old name among them.
struct UpdatedArguments {
    std::vector<std::string> arguments, advice;
};
UpdatedArguments replace_former_names(const Command& program, const std::vector<std::string>& arguments);

}  // namespace lostbits::analysis::shell
