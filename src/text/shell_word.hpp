// Quotes words for a POSIX shell.
#pragma once

#include <string>
#include <string_view>

namespace lostbits::text {

/// Quotes a word for a shell: in single quotes if it holds more than letters, digits and _./=,:+-.
[[nodiscard]] std::string shell_word(std::string_view word);

}  // namespace lostbits::text
