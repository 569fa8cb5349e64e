// The words of a GLSL file with their places, as far as finding a function in it asks for.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::intersect::shader {

struct Token {
    enum class Kind { name, number, sign, comment };
    Kind kind;
    std::string_view text;     ///< of the file's text, which outlives the token
    std::size_t offset;        ///< where it begins in that text
    std::size_t line, column;  ///< from 1; columns are bytes
    bool in_directive;         ///< on a line that begins with #, or on one that continues it
};

/// Every token. What GLSL does not know becomes a sign of one byte; a comment that does not end goes to the end.
std::vector<Token> tokens_of(std::string_view text);

/// The same without comments and without directives: what declares and computes.
std::vector<Token> code_tokens(const std::vector<Token>& all);

/// `line:column` of a place in a text, from 1.
std::string place_in(std::string_view text, std::size_t offset);

}  // namespace lostbits::intersect::shader
