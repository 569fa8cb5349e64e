// Places of the user's text behind the lines that SPIR-V names. glslang writes lines without columns. So it gets each
// token on a line of its own: the line then says the column, too.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::spirv {

/// A token of the user's text; line 0 for one that we added.
struct TokenPlace {
    std::string text;
    int line = 0, column = 0;
};

struct ShaderLines {
    std::string file;                ///< path of the user's text; empty: places are lines of the assembly
    std::vector<TokenPlace> tokens;  ///< the token of each line; empty: lines are those of the user's text
    std::vector<std::string> lines;  ///< the user's text, if `tokens` is empty
};

/// A program of one token a line around the functions of a file, and its lines. Columns and lines stay those of the
/// file. The program has a main function, which calls the named function if the file is HLSL: glslang leaves others
/// out.
std::string split_program(const std::string& text, device::Language language, ShaderLines& lines);

/// The same program with the lines of the file, for the messages of the compiler.
std::string whole_program(const std::string& text, device::Language language);

/// Finds the place of an operation. An operator, such as the `-` of `a - b`, is named before its operands are, and its
/// instruction comes after theirs: they match like brackets.
class PlaceFinder {
public:
    explicit PlaceFinder(const ShaderLines& lines);
    void begin_function() { visited_.clear(); }
    void visit(int line, int column);
    /// Place of an instruction. `extended` is the name of an extended one, such as Sqrt. Line 0: unknown.
    TokenPlace place_of(std::string_view op, std::string_view extended);
    /// The name before the bracket that closes at the last visited token, and else that token.
    [[nodiscard]] TokenPlace last() const;

private:
    [[nodiscard]] std::size_t name_of(std::size_t token) const;
    [[nodiscard]] bool take_last(char sign, std::size_t& token);

    const ShaderLines& lines_;
    std::vector<std::size_t> opening_;  ///< of each closing bracket, the opening one
    std::vector<std::size_t> visited_;
    TokenPlace now_;
    std::size_t token_ = 0;
};

}  // namespace lostbits::intersect::spirv
