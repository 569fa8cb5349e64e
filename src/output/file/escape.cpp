// Escapes text for each kind of output.
#include "output/file/escape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "output/file/csv.hpp"

namespace lostbits::output::file {
namespace {

/// True for characters that a terminal obeys instead of showing, or shows elsewhere: the controls C0 and C1, line and
/// paragraph separators, marks and embeddings of direction, and characters without width.
bool is_control(char32_t c) {
    return c < 0x20 || (c >= 0x7F && c <= 0x9F) || c == 0x61C || (c >= 0x200B && c <= 0x200F) ||
           (c >= 0x2028 && c <= 0x202E) || (c >= 0x2060 && c <= 0x206F) || c == 0xFEFF || c == 0xFFFE || c == 0xFFFF;
}

/// True for a blank, and for every byte of a character that is not ASCII: runners also trim Unicode's other spaces.
bool is_blank(char c) { return c == ' ' || c == '\t' || static_cast<unsigned char>(c) >= 0x80; }

/// True if a CI runner takes the line with text[start] for a command: the line begins there with `::`, perhaps after
/// blanks.
bool begins_command(std::string_view text, std::size_t start) {
    if (!text.substr(start).starts_with("::")) return false;
    while (start > 0 && is_blank(text[start - 1])) --start;
    return start == 0 || text[start - 1] == '\n';
}

enum class LineBreaks { kept, escaped };

std::string escape_for_terminal(std::string_view text, LineBreaks line_breaks) {
    std::string out;
    for (std::size_t position = 0; position < text.size();) {
        const auto [code, size] = first_character(text.substr(position));
        if (size == 0) {
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[position++]));
            continue;
        }

        if (code == '\n' || code == '\t')
            out += line_breaks == LineBreaks::kept ? std::string(1, text[position]) : code == '\n' ? "\\n" : "\\t";
        else if (is_control(code) && size == 1) out += fmt::format("\\x{:02x}", static_cast<unsigned>(code));
        else if (is_control(code)) out += fmt::format("\\u{{{:x}}}", static_cast<unsigned>(code));
        else if (code == ':' && begins_command(text, position)) out += "\\x3a";
        else if (text.substr(position).starts_with("##[")) out += "\\x23";
        else out += text.substr(position, size);
        position += size;
    }
    return out;
}

/// Replaces each character of `escaped` by `%` and its two hexadecimal digits.
std::string percent_encode(std::string_view text, std::string_view escaped) {
    std::string out;
    for (const char c : text) {
        if (escaped.find(c) == std::string_view::npos) out += c;
        else out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return out;
}

/// True for characters that no document should hold: the controls C0 and C1 (tab and line feed are text); characters
/// that reverse other text, which could make a table or a comment read as something else; separators at which some
/// readers end a line; and codes that are not characters.
bool is_forbidden(char32_t c) {
    return (c < 0x20 && c != '\n' && c != '\t') || (c >= 0x7F && c <= 0x9F) || c == 0x61C || c == 0x200E ||
           c == 0x200F || (c >= 0x2028 && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069) || c == 0xFFFE || c == 0xFFFF;
}

/// Makes one line of the text, with only characters that every reader accepts and shows in their place.
std::string to_plain_line(std::string_view text) {
    std::string line = xml_text(text);
    std::ranges::replace_if(
        line, [](char c) { return c == '\n' || c == '\t'; }, ' ');
    return line;
}

}  // namespace

std::string terminal_text(std::string_view text) { return escape_for_terminal(text, LineBreaks::kept); }
std::string terminal_line(std::string_view text) { return escape_for_terminal(text, LineBreaks::escaped); }

std::string xml_text(std::string_view text) {
    std::string out;
    const std::string valid = to_valid_utf8(text);
    for (std::string_view rest = valid; !rest.empty();) {
        const auto [code, size] = first_character(rest);
        if (code == '\r') out += rest.substr(1).starts_with('\n') ? "" : "\n";
        else if (is_forbidden(code)) out += "\xEF\xBF\xBD";
        else out += rest.substr(0, size);
        rest.remove_prefix(size);
    }
    return out;
}

namespace {

/// True if a Markdown reader takes the text from line[start] for an entity: `&lt;`, `&#60;`.
bool is_entity(std::string_view line, std::size_t start) {
    if (line[start] != '&') return false;
    const auto end = std::ranges::find_if_not(
        line.substr(start + 1), [](unsigned char c) { return c == '#' || (c < 0x80 && std::isalnum(c) != 0); });
    const auto length = static_cast<std::size_t>(end - line.begin()) - start - 1;
    return length > 0 && start + 1 + length < line.size() && *end == ';';
}

}  // namespace

std::string html(std::string_view text) {
    std::string out;
    for (const char c : xml_text(text)) {
        if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '>') out += "&gt;";
        else if (c == '"') out += "&quot;";
        else out += c;
    }
    return out;
}

std::string markdown_text(std::string_view text) {
    const std::string line = to_plain_line(text);
    std::string out;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i], next = i + 1 < line.size() ? line[i + 1] : ' ';
        const bool opens_tag = c == '<' && next != ' ' && next != '=' && next != '<';
        if (opens_tag || is_entity(line, i) || c == '\\' || c == '|' || c == '[' || c == ']') out += '\\';
        out += c;
    }
    return out;
}

std::string markdown_code(std::string_view text) {
    std::string line = to_plain_line(text);
    // The fence has one backtick more than the longest run of backticks inside.
    std::size_t longest_run = 0, run_length = 0;
    for (const char c : line) longest_run = std::max(longest_run, run_length = c == '`' ? run_length + 1 : 0);
    const std::string fence(longest_run + 1, '`'), gap = longest_run > 0 || line.empty() ? " " : "";
    for (std::size_t position = 0; (position = line.find('|', position)) != std::string::npos; position += 2) {
        // A backslash in front would escape the backslash that is inserted here.
        if (position > 0 && line[position - 1] == '\\') line.insert(position++, " ");
        line.insert(position, "\\");
    }
    return fence + gap + line + gap + fence;
}

std::string markdown_path(std::string_view path) {
    return percent_encode(
        path,
        "%\\ \"'()<>[]`|*{}^#?&!:\t\n\r\x0B\x0C\x01\x02\x03\x04\x05\x06\x07\x08\x0E\x0F\x10\x11\x12\x13"
        "\x14\x15\x16\x17\x18\x19\x1A\x1B\x1C\x1D\x1E\x1F\x7F");
}

std::string workflow_text(std::string_view text) { return percent_encode(terminal_text(text), "%\n"); }
std::string workflow_value(std::string_view text) { return percent_encode(terminal_text(text), "%\n:,"); }

std::string c_comment(std::string_view text) {
    std::string out;
    for (const char original : to_plain_line(text)) {
        // A backslash at the end of a line joins the next line to it. Two question marks may begin a trigraph; `??/` is
        // a backslash.
        const char c = original == '\\' ? '/' : original, last = out.empty() ? ' ' : out.back();
        if ((last == '*' && c == '/') || (last == '/' && c == '*') || (last == '?' && c == '?')) out += ' ';
        out += c;
    }
    return out;
}

std::string line_comment(std::string_view text) {
    std::string line = to_plain_line(text);
    // GCC also joins lines if blanks follow the backslash.
    const std::string_view without_blanks = std::string_view(line).substr(0, line.find_last_not_of(' ') + 1);
    return without_blanks.ends_with('\\') || without_blanks.ends_with("?\?/") ? line + "." : line;
}

std::string c_string(std::string_view text) {
    std::string out = "\"";
    const auto add_bytes = [&out](std::string_view bytes) {
        // Always three digits, because a digit may follow.
        for (const char c : bytes) out += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
    };
    for (std::size_t position = 0; position < text.size();) {
        const auto [code, size] = first_character(text.substr(position));
        const std::string_view character = text.substr(position, std::max<std::size_t>(size, 1));
        const bool may_be_trigraph = code == '?' && position > 0 && text[position - 1] == '?';
        if (size == 0 || is_control(code)) add_bytes(character);
        else if (code == '"' || code == '\\' || may_be_trigraph) out.append("\\").append(character);
        else out += character;
        position += character.size();
    }
    return out + '"';
}

std::string toml_string(std::string_view text) {
    std::string out = "\"";
    const std::string valid = to_valid_utf8(text);
    for (std::string_view rest = valid; !rest.empty();) {
        const auto [code, size] = first_character(rest);
        if (is_control(code)) out += fmt::format("\\u{:04X}", static_cast<unsigned>(code));  // none is above U+FFFF
        else if (code == '"' || code == '\\') out.append("\\").append(rest.substr(0, size));
        else out += rest.substr(0, size);
        rest.remove_prefix(size);
    }
    return out + '"';
}

}  // namespace lostbits::output::file
