// Finds the places in the user's text for the lines that SPIR-V names. glslang writes lines without columns. So each
// token is passed to glslang on a line of its own, and the line then also gives the column.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::spirv {

/// A token of the user's text; line 0 for a token that we added.
struct TokenPlace {
    std::string text;
    int line = 0, column = 0;
};

struct ShaderLines {
    std::string file;                ///< path of the user's text; if empty, positions refer to lines of the assembly
    std::vector<TokenPlace> tokens;  ///< the token of each line; if empty, lines are those of the user's text
    std::vector<std::string> lines;  ///< the user's text, if `tokens` is empty
};

/// Returns a program with one token per line around the functions of a file, and sets `lines`. Columns and lines stay
/// those of the file. The program has a main function, which calls the named function if the file is HLSL: glslang
/// leaves other functions out.
std::string write_program_with_token_lines(const std::string& text, device::Language language, ShaderLines& lines);

/// The same program with the lines of the file, for the messages of the compiler.
std::string write_program_with_user_lines(const std::string& text, device::Language language);

/// Finds the place of an operation. glslang names the line of an operator, such as the `-` of `a - b`, before the lines
/// of its operands, but writes the operator's instruction after theirs. So operators and instructions match like
/// brackets.
class PlaceFinder {
public:
    explicit PlaceFinder(const ShaderLines& lines);
    void begin_function() { visited_.clear(); }
    void visit(int line, int column);
    /// Place of an instruction. `extended` is the name of an extended instruction, such as Sqrt. Line 0 if the place is
    /// unknown.
    TokenPlace place_of(std::string_view op, std::string_view extended);
    /// If the last visited token is a closing bracket, the name before the matching opening bracket; else the last
    /// visited token.
    [[nodiscard]] TokenPlace last_visited() const;

private:
    [[nodiscard]] TokenPlace place_in_line(char sign) const;
    [[nodiscard]] std::size_t name_of(std::size_t token) const;
    [[nodiscard]] bool take_last(char sign, std::size_t& token);

    const ShaderLines& lines_;
    std::vector<std::size_t> opening_;  ///< index of the opening bracket of each closing bracket
    std::vector<std::size_t> visited_;
    TokenPlace current_place_;
    std::size_t token_ = 0;
};

}  // namespace lostbits::intersect::spirv
