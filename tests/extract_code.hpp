// Code of a program without comments and strings. Untrusted text must never appear in it.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace lostbits::test {

/// Comments of a language: the characters that begin a comment to the end of the line, and whether the language has C's
/// other comments, characters, and lines that continue after a backslash.
struct Language {
    std::string_view line_comment;
    bool is_c = false;
};
inline constexpr Language c_code{"//", true}, fpcore_code{";"}, toml_code{"#"};

/// Lines of C as compilers join them: after a backslash, even if it is written as a trigraph or followed by blanks.
inline std::string join_lines(std::string text) {
    for (std::size_t at = 0; (at = text.find("?\?/", at)) != std::string::npos; ++at) text.replace(at, 3, "\\");
    for (std::size_t at = 0; (at = text.find('\\', at)) != std::string::npos;) {
        const std::size_t end = text.find_first_not_of(" \t\r", at + 1);
        if (end != std::string::npos && text[end] == '\n') text.erase(at, end - at + 1);
        else at += 2;
    }
    return text;
}

inline std::string extract_code(std::string text, const Language& language) {
    if (language.is_c) text = join_lines(std::move(text));
    const std::string_view all = text;
    std::string code;
    for (std::size_t at = 0; at < all.size();) {
        std::size_t end = at + 1;
        const char c = all[at];
        if (all.substr(at).starts_with(language.line_comment)) {
            end = std::min(all.find('\n', at), all.size());
        } else if (language.is_c && all.substr(at).starts_with("/*")) {
            end = std::min(all.find("*/", at + 2), all.size() - 2) + 2;
        } else if (c == '"' || (language.is_c && c == '\'')) {
            while (end < all.size() && all[end] != c && all[end] != '\n') end += all[end] == '\\' ? 2 : 1;
            code += c;  // a string that does not end on its line still begins there
            if (end < all.size() && all[end] == c) code += c, ++end;
        } else {
            code += c;
        }
        at = std::min(end, all.size());
    }
    return code;
}

}  // namespace lostbits::test
