#include "intersect/shader/compiler_log.hpp"

#include <cstdio>
#include <sstream>

#include "intersect/external/pipe_header.hpp"
#include "intersect/shader/kernel.hpp"

namespace lostbits::intersect::shader {
namespace {

/// A message of a compiler's log that names a position.
struct LogMessage {
    int line = 0, column = 0;  ///< column as Mesa counts it, see `column_of`; 0 if the log gives no column
    std::string content;
};

/// Reads a line of a log. Returns false if the line names no position.
bool read_message(const std::string& text, LogMessage& message) {
    int text_offset = 0;
    // Mesa: `1:12(5): error: TEXT`; glslang and AMD: `ERROR: 1:12: TEXT`; NVIDIA: `1(12) : error C1008: TEXT`.
    if (std::sscanf(text.c_str(), "%*d:%d(%d): %n", &message.line, &message.column, &text_offset) == 2 &&
        text_offset > 0) {
    } else if (std::sscanf(text.c_str(), "%*[A-Z]: %*[^:]:%d: %n", &message.line, &text_offset) == 1 &&
               text_offset > 0) {
    } else if (std::sscanf(text.c_str(), "%*d(%d) : %n", &message.line, &text_offset) == 1 && text_offset > 0) {
    } else {
        return false;
    }
    message.content = text.substr(static_cast<std::size_t>(text_offset));
    if (message.content.starts_with("error: ")) message.content.erase(0, 7);
    return true;
}

bool is_warning(const std::string& line) {
    return line.find("warning") != std::string::npos || line.starts_with("WARNING");
}

std::string line_of(const std::string& text, int line_number) {
    std::istringstream lines(text);
    std::string line;
    for (int i = 0; i < line_number; ++i) {
        if (!std::getline(lines, line)) return "";  // a `#line` in the text may give any number
    }
    return line;
}

/// Returns the column in the file, from 1. Mesa counts adjacent blanks as one. If the compiler gives no column, returns
/// the column of the text that the compiler quotes, or else of the first text in the line.
int column_of(const LogMessage& message, const std::string& line) {
    const auto is_blank = [](char x) { return x == ' ' || x == '\t'; };
    int mesa_column = 0;
    for (std::size_t i = 0; message.column > 0 && i < line.size(); ++i) {
        mesa_column += i == 0 || !is_blank(line[i]) || !is_blank(line[i - 1]);
        if (mesa_column == message.column) return static_cast<int>(i) + 1;
    }

    const std::size_t open = message.content.find_first_of("'\""),
                      close = message.content.find_first_of("'\"", open + 1);
    std::size_t position = std::string::npos;
    if (close != std::string::npos) position = line.find(message.content.substr(open + 1, close - open - 1));
    if (position == std::string::npos) position = line.find_first_not_of(" \t");
    return position == std::string::npos ? 1 : static_cast<int>(position) + 1;
}

/// Returns advice to add to a compiler's message; empty if no advice fits the message.
std::string advice_for(const std::string& message_text) {
    const auto has = [&message_text](const char* part) { return message_text.find(part) != std::string::npos; };
    if (has("non-opaque uniforms")) return " (write a constant, or try --device opengl)";
    if (has("discard") || has("dFd") || has("fwidth"))
        return " (only pixel shaders have this; move the intersector into a file of its own)";
    if (has("texture2D")) return " (current GLSL calls it texture)";
    return "";
}

}  // namespace

std::string errors_of(const std::string& log, const ShaderSource& shader) {
    const int max_errors = shader.is_hlsl ? 1 : 8;  // in HLSL the first error causes the errors that follow
    std::istringstream lines(log);
    std::string messages, lines_without_position;
    int error_count = 0;
    for (std::string line; std::getline(lines, line);) {
        LogMessage message;
        if (!read_message(line, message)) {
            if (!line.empty()) lines_without_position += "\n  " + external::quote_text(line, 200);
            continue;
        }
        if (is_warning(line) || error_count == max_errors ||
            message.content.find("compilation terminated") != std::string::npos)
            continue;

        // A position in our own code means the call of the user's function.
        ++error_count;
        const std::string message_text = external::escape_text(message.content);
        const Function& f = shader.signature.function;
        if (!messages.empty()) messages += "\n";
        if (message.line < kernel_first_line)
            messages += shader.path + ":" + std::to_string(message.line) + ":" +
                        std::to_string(column_of(message, line_of(shader.text, message.line))) + ": " + message_text +
                        advice_for(message_text);
        else
            messages += shader.path + ":" + std::to_string(f.line) + ":" + std::to_string(f.column) +
                        ": the call of `" + f.name + "` is rejected (is it inside an #if?): " + message_text;
    }
    return !messages.empty()
               ? messages
               : shader.path + ":1:1: the driver's compiler rejects it" +
                     (lines_without_position.empty() ? " and does not say why" : ":" + lines_without_position);
}

}  // namespace lostbits::intersect::shader
