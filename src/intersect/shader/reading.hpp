// Reads as much of a GLSL file as is needed to find a function in the file: the tokens with their positions, the
// functions that the file defines, and the loops with a stated bound.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::intersect::shader {

struct Token {
    enum class Kind { name, number, sign, comment };
    Kind kind;
    std::string_view text;     ///< points into the text of the file, which must outlive the token
    std::size_t offset;        ///< index of its first byte in the text
    std::size_t line, column;  ///< from 1; columns are bytes
    bool in_directive;         ///< true on a line that begins with #, or on a line that continues such a line
};

/// Reads every token. A byte that GLSL does not know becomes a sign. A comment without an end reaches to the end of the
/// text.
std::vector<Token> split_into_tokens(std::string_view text);

/// Returns the tokens that are neither in comments nor in directives.
std::vector<Token> code_tokens(const std::vector<Token>& tokens);

struct Parameter {
    enum class Qualifier { in, out, inout };
    Qualifier qualifier = Qualifier::in;
    std::string type;  ///< `vec3`; with brackets for an array
    std::string name;  ///< empty if the parameter has no name
};

struct Function {
    std::string type, name;
    std::vector<Parameter> parameters;
    std::size_t line = 0, column = 0;  ///< position of its name

    /// The declaration, such as `float sphere(vec3 ro, vec3 rd, vec4 s)`.
    [[nodiscard]] std::string declaration() const;
};

/// Returns every function with a body, in the order of the file. `code` holds the tokens that `code_tokens` returns.
std::vector<Function> find_functions(const std::vector<Token>& code);

/// A loop that an integer in the file bounds, or that has no bound.
struct CountedLoop {
    static constexpr long long endless = 1'000'000'000'001;  ///< above the count of any bounded loop

    std::size_t line;
    long long max_iterations;         ///< largest number of iterations
    long long max_nested_iterations;  ///< `max_iterations` times the iterations of all enclosing loops
};

/// Returns the loops whose header has an integer, and the loops without an end. `tokens` holds the tokens of the file,
/// `code` those that `code_tokens` returns.
std::vector<CountedLoop> find_counted_loops(const std::vector<Token>& tokens, const std::vector<Token>& code);

}  // namespace lostbits::intersect::shader
