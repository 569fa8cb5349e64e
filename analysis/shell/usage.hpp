// What is said where the words of a command line are not understood.
#pragma once

#include <string>
#include <vector>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::shell {

/// What is wrong, why, and what to try: a sentence for what the parser threw.
std::string describe_misread(const CommandLine& program, const Misread& error);

/// The message, with the line breaks that somebody typed into one of the words as `\n`: its own stay.
std::string with_words_on_one_line(const std::string& message, const std::vector<std::string>& words);

}  // namespace lostbits::analysis::shell
