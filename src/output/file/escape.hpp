// Text that users write, for where it goes: one function per kind of output. `csv_field` (csv.hpp), `html`
// (page/text.hpp), `shell_word` (intersect/process/child.hpp), the names in `\mathit`
// (measure/blame/tape_text.hpp) and nlohmann's JSON are the others.
#pragma once

#include <string>
#include <string_view>

namespace lostbits::output::file {

/// For a terminal or a log of a job: what would move the cursor, colour, or hide or turn around other text is written
/// as `\x1b` (a byte) or `\u{202e}` (a character), and so is a byte that is not UTF-8. A line that a runner of jobs
/// would take for a command (`::error`, `##[error]`) gets `\x3a` or `\x23` in it. Line breaks and tabs stay.
[[nodiscard]] std::string terminal_text(std::string_view text);

/// The same on one line: a line break is `\n`, a tab `\t`.
[[nodiscard]] std::string terminal_line(std::string_view text);

/// For XML 1.0, before a library writes `&lt;`: U+FFFD in place of every character that no document may hold (U+0000
/// to U+001F but tab and line feed, U+FFFE, U+FFFF), of the controls U+007F to U+009F, of what turns text around or
/// separates lines (U+061C, U+200E, U+200F, U+2028 to U+202E, U+2066 to U+2069) and of every byte that is not UTF-8; a
/// carriage return, which readers turn into a line feed, is one.
[[nodiscard]] std::string xml_text(std::string_view text);

/// For a line of Markdown: no markup, no tag, no link, no line break, and no end of a cell of a table. Emphasis stays.
[[nodiscard]] std::string markdown_text(std::string_view text);

/// As code in a line of Markdown, cells of tables included.
[[nodiscard]] std::string markdown_code(std::string_view text);

/// As what a link or a picture leads to: a relative path.
[[nodiscard]] std::string markdown_path(std::string_view path);

/// What stands behind the second `::` of a command to GitHub's runner, which reads `terminal_text` back from it.
[[nodiscard]] std::string workflow_text(std::string_view text);

/// The value of `file=`, `line=` or `title=` of such a command.
[[nodiscard]] std::string workflow_value(std::string_view text);

/// Inside a comment of C, between `/*` and `*/`.
[[nodiscard]] std::string c_comment(std::string_view text);

/// Behind `//` in C, C++ and GLSL: one line, which neither a backslash nor a trigraph at its end joins to the next.
/// Every other character stays, so that a command can be copied from it.
[[nodiscard]] std::string line_comment(std::string_view text);

/// A literal of C and of C++, quotation marks included, from which a compiler reads the same bytes back.
[[nodiscard]] std::string c_string(std::string_view text);

/// A basic string of TOML, quotation marks included. Bytes that are not UTF-8, which no TOML holds, are U+FFFD.
[[nodiscard]] std::string toml_string(std::string_view text);

}  // namespace lostbits::output::file
