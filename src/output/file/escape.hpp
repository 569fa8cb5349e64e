// Escapes text that users wrote: one function per kind of output. Other escapes are `quoted_field` (csv.hpp),
// `shell_word` (text/shell_word.hpp) and nlohmann's JSON.
#pragma once

#include <string>
#include <string_view>

namespace lostbits::output::file {

/// Escapes text for a terminal or the log of a CI job. Characters that would move the cursor, change colours, or hide
/// or reverse other text are written as `\x1b` (a byte) or `\u{202e}` (a character); so is every byte that is not
/// UTF-8. In a line that a CI runner would take for a command (`::error`, `##[error]`), the first `:` becomes `\x3a` or
/// the first `#` becomes `\x23`. Line breaks and tabs stay.
[[nodiscard]] std::string terminal_text(std::string_view text);

/// Like `terminal_text`, on one line: a line break becomes `\n` and a tab `\t`.
[[nodiscard]] std::string terminal_line(std::string_view text);

/// Cleans text for XML 1.0, before a library writes `&lt;`. U+FFFD replaces: characters that no document may hold
/// (U+0000 to U+001F except tab and line feed, U+FFFE, U+FFFF); the controls U+007F to U+009F; characters that reverse
/// text or separate lines (U+061C, U+200E, U+200F, U+2028 to U+202E, U+2066 to U+2069); and every byte that is not
/// UTF-8. A carriage return, which readers turn into a line feed, becomes a line feed.
[[nodiscard]] std::string xml_text(std::string_view text);

/// Escapes text for HTML and SVG, between tags and in quoted attributes: `xml_text` with &, <, > and quotes as
/// entities.
[[nodiscard]] std::string html(std::string_view text);

/// Escapes text for a line of Markdown. The text cannot make a tag, a link, a line break or the end of a table cell.
/// Emphasis stays.
[[nodiscard]] std::string markdown_text(std::string_view text);

/// Makes a code span for a line of Markdown or a cell of its tables.
[[nodiscard]] std::string markdown_code(std::string_view text);

/// Escapes a relative path that is the target of a link or a picture in Markdown.
[[nodiscard]] std::string markdown_path(std::string_view path);

/// Escapes the text after the second `::` of a command to GitHub's runner. The runner reads `terminal_text` back from
/// it.
[[nodiscard]] std::string workflow_text(std::string_view text);

/// Escapes the value of `file=`, `line=` or `title=` in a command to GitHub's runner.
[[nodiscard]] std::string workflow_value(std::string_view text);

/// Escapes text for a C comment, between `/*` and `*/`.
[[nodiscard]] std::string c_comment(std::string_view text);

/// Escapes text for a comment after `//` in C, C++ and GLSL: one line, which no backslash or trigraph at its end joins
/// to the next. Everything else stays, so that a command can be copied from the comment.
[[nodiscard]] std::string line_comment(std::string_view text);

/// Makes a string literal of C and C++, with its quotation marks. A compiler reads the same bytes back.
[[nodiscard]] std::string c_string(std::string_view text);

/// Makes a basic string of TOML, with its quotation marks. U+FFFD replaces bytes that are not UTF-8, which TOML cannot
/// hold.
[[nodiscard]] std::string toml_string(std::string_view text);

}  // namespace lostbits::output::file
