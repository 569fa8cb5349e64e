// Reads as much of a GLSL file as is needed to find a function in it: its tokens with their positions, the functions
// that it defines, and the loops with a stated bound.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::intersect::shader {

struct Token {
    enum class Kind { name, number, sign, comment };
    Kind kind;
    std::string_view text;     ///< points into the text of the file, which outlives the token
    std::size_t offset;        ///< of its first byte in that text
    std::size_t line, column;  ///< from 1; columns are bytes
    bool in_directive;         ///< on a line that begins with #, or on one that continues it
};

/// Reads every token. A byte that GLSL does not know becomes a sign; a comment without an end reaches to the end.
std::vector<Token> tokens_of(std::string_view text);

/// The tokens without comments and directives.
std::vector<Token> code_tokens(const std::vector<Token>& all);

/// `line:column` of an offset in a text, both from 1.
std::string place_in(std::string_view text, std::size_t offset);

struct Parameter {
    enum class Qualifier { in, out, inout };
    Qualifier qualifier = Qualifier::in;
    std::string type;  ///< `vec3`; with brackets if it is an array
    std::string name;  ///< empty if it has none
};

struct Function {
    std::string type, name;
    std::vector<Parameter> parameters;
    std::size_t line = 0, column = 0;  ///< position of its name

    /// `float sphere(vec3 ro, vec3 rd, vec4 s)`
    [[nodiscard]] std::string words() const;
};

/// Every function with a body, in the order of the file. `code` are the tokens that `code_tokens` returns.
std::vector<Function> functions_of(const std::vector<Token>& code);

/// A loop that the file bounds by a whole number, or not at all.
struct CountedLoop {
    static constexpr long long endless = 1'000'000'000'001;  ///< above the count of any bounded loop

    std::size_t line;
    long long most;      ///< largest number of iterations
    long long together;  ///< that number times those of the enclosing loops
};

/// The loops that begin at or are compared with a whole number, and the loops without an end. `all` are the tokens of
/// the file, `code` those that `code_tokens` returns.
std::vector<CountedLoop> loops_of(const std::vector<Token>& all, const std::vector<Token>& code);

}  // namespace lostbits::intersect::shader
