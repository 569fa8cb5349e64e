#include "intersect/shader/compiler_log.hpp"

#include <cstdio>
#include <sstream>

#include "intersect/external/pipe_header.hpp"
#include "intersect/shader/kernel.hpp"

namespace lostbits::intersect::shader {
namespace {

/// One line of a log that names a position.
struct Complaint {
    int line = 0, column = 0;  ///< column as Mesa counts it, see `column_of`; 0: not given
    std::string words;
};

/// Reads a line of a log. False if it names no position.
bool read(const std::string& text, Complaint& c) {
    int used = 0;
    // Mesa: `1:12(5): error: words`; glslang and AMD: `ERROR: 1:12: words`; NVIDIA: `1(12) : error C1008: words`.
    if (std::sscanf(text.c_str(), "%*d:%d(%d): %n", &c.line, &c.column, &used) == 2 && used > 0) {
    } else if (std::sscanf(text.c_str(), "%*[A-Z]: %*[^:]:%d: %n", &c.line, &used) == 1 && used > 0) {
    } else if (std::sscanf(text.c_str(), "%*d(%d) : %n", &c.line, &used) == 1 && used > 0) {
    } else {
        return false;
    }
    c.words = text.substr(static_cast<std::size_t>(used));
    if (c.words.starts_with("error: ")) c.words.erase(0, 7);
    return true;
}

bool is_warning(const std::string& line) {
    return line.find("warning") != std::string::npos || line.starts_with("WARNING");
}

std::string line_of(const std::string& text, int number) {
    std::istringstream lines(text);
    std::string line;
    for (int i = 0; i < number; ++i) {
        if (!std::getline(lines, line)) return "";  // a `#line` in the text may give any number
    }
    return line;
}

/// Column in the file, from 1. Mesa counts adjacent blanks as one. If the compiler gives no column, the column of the
/// text that it quotes, or else of the first text in the line.
int column_of(const Complaint& c, const std::string& line) {
    const auto is_blank = [](char x) { return x == ' ' || x == '\t'; };
    int counted = 0;
    for (std::size_t i = 0; c.column > 0 && i < line.size(); ++i) {
        counted += i == 0 || !is_blank(line[i]) || !is_blank(line[i - 1]);
        if (counted == c.column) return static_cast<int>(i) + 1;
    }
    const std::size_t open = c.words.find_first_of("'\""), close = c.words.find_first_of("'\"", open + 1);
    std::size_t at = std::string::npos;
    if (close != std::string::npos) at = line.find(c.words.substr(open + 1, close - open - 1));
    if (at == std::string::npos) at = line.find_first_not_of(" \t");
    return at == std::string::npos ? 1 : static_cast<int>(at) + 1;
}

/// Advice to add to a message of a compiler; empty if there is none.
std::string advice(const std::string& words) {
    const auto has = [&words](const char* part) { return words.find(part) != std::string::npos; };
    if (has("non-opaque uniforms")) return " (write a constant, or try --device opengl)";
    if (has("discard") || has("dFd") || has("fwidth"))
        return " (only pixel shaders have this; move the intersector into a file of its own)";
    if (has("texture2D")) return " (current GLSL calls it texture)";
    return "";
}

}  // namespace

std::string errors_of(const std::string& log, const ShaderSource& shader) {
    const int most = shader.hlsl ? 1 : 8;  // in HLSL the first error causes those that follow
    std::istringstream lines(log);
    std::string all, unplaced;
    int found = 0;
    for (std::string line; std::getline(lines, line);) {
        Complaint c;
        if (!read(line, c)) {
            if (!line.empty()) unplaced += "\n  " + external::shown_text(line, 200);
            continue;
        }
        if (is_warning(line) || found == most || c.words.find("compilation terminated") != std::string::npos) continue;
        ++found;
        const std::string words = external::plain_text(c.words);
        const Function& f = shader.signature.function;
        if (!all.empty()) all += "\n";
        if (c.line < our_first_line)
            all += shader.path + ":" + std::to_string(c.line) + ":" +
                   std::to_string(column_of(c, line_of(shader.text, c.line))) + ": " + words + advice(words);
        else
            all += shader.path + ":" + std::to_string(f.line) + ":" + std::to_string(f.column) + ": the call of `" +
                   f.name + "` is rejected (is it inside an #if?): " + words;
    }
    return !all.empty() ? all
                        : shader.path + ":1:1: the driver's compiler rejects it" +
                              (unplaced.empty() ? " and does not say why" : ":" + unplaced);
}

}  // namespace lostbits::intersect::shader
