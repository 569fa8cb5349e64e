// What is said where the words of a command line are not understood.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace lostbits::analysis::shell {

/// What is wrong, why, and what to try: a sentence for what the parser threw.
std::string what_is_wrong(const CLI::App& program, const CLI::ParseError& error);

/// The message, with the line breaks that somebody typed into one of the words as `\n`: its own stay.
std::string with_words_on_one_line(const std::string& message, const std::vector<std::string>& words);

/// The command that was named, or the program itself.
const CLI::App& command_named(const CLI::App& program);

/// The names of its commands; groups of options are commands without a name.
std::vector<std::string> commands_of(const CLI::App& program);

}  // namespace lostbits::analysis::shell
