// Old names of options. They still work, and a line of advice gives the new name.
#pragma once

#include <string>
#include <vector>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::shell {

/// Arguments with the present names of options, and a sentence of advice for each old name among them.
struct UpdatedArguments {
    std::vector<std::string> arguments, advice;
};
UpdatedArguments replace_former_names(const Command& program, const std::vector<std::string>& arguments);

}  // namespace lostbits::analysis::shell
