// Scripts that complete the words of the program, and its manual page.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace lostbits::analysis::shell {

/// For bash, zsh and fish. Names of forms, scenes and so on are asked of the program when they are needed, so those of
/// one's own data are there too.
std::string bash_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);
std::string fish_completion(const CLI::App& program);

/// The manual page, in the macros of man(7): the words of `--help`, all commands on one page.
std::string manual_page(const CLI::App& program, const std::string& version);

}  // namespace lostbits::analysis::shell
