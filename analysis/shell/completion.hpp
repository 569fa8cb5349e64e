// Scripts that complete the words of the program, and its manual page.
#pragma once

#include <string>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::shell {

/// For bash, zsh and fish. Names of forms, scenes and so on are asked of the program when they are needed, so those of
/// one's own data are there too.
std::string bash_completion(const Command& program);
std::string zsh_completion(const Command& program);
std::string fish_completion(const Command& program);

/// The manual page, in the macros of man(7): the words of `--help`, all commands on one page, and `footer`.
std::string manual_page(const Command& program, const std::string& version, const std::string& footer);

}  // namespace lostbits::analysis::shell
