#include "text/shell_word.hpp"

#include <algorithm>

namespace lostbits::text {

std::string shell_word(std::string_view word) {
    const auto is_safe = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("_./=,:+-").find(c) != std::string_view::npos;
    };
    // zsh replaces a word that begins with = by the path of a command, so such a word is quoted.
    if (!word.empty() && word.front() != '=' && std::ranges::all_of(word, is_safe)) return std::string(word);
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

}  // namespace lostbits::text
