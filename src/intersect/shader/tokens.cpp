#include "intersect/shader/tokens.hpp"

#include <algorithm>
#include <cctype>

namespace lostbits::intersect::shader {
namespace {

bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Where the token that begins at `at`, no white space, ends.
std::size_t end_of(std::string_view text, std::size_t at, Token::Kind& kind) {
    const auto while_ = [&](std::size_t end, auto belongs) {
        while (end < text.size() && belongs(end)) ++end;
        return end;
    };
    const auto of_a_name = [&](std::size_t i) { return begins_name(text[i]) || is_digit(text[i]); };
    if (text.substr(at, 2) == "//") {
        kind = Token::Kind::comment;
        return std::min(text.find('\n', at), text.size());
    }
    if (text.substr(at, 2) == "/*") {
        kind = Token::Kind::comment;
        const std::size_t end = text.find("*/", at + 2);
        return end == std::string_view::npos ? text.size() : end + 2;
    }
    if (begins_name(text[at])) {
        kind = Token::Kind::name;
        return while_(at, of_a_name);
    }
    if (is_digit(text[at]) || (text[at] == '.' && at + 1 < text.size() && is_digit(text[at + 1]))) {
        kind = Token::Kind::number;
        const bool hex = text.substr(at, 2) == "0x" || text.substr(at, 2) == "0X";
        return while_(at, [&](std::size_t i) {
            const bool signed_exponent =
                (text[i] == '+' || text[i] == '-') && i > at && !hex && (text[i - 1] == 'e' || text[i - 1] == 'E');
            return of_a_name(i) || text[i] == '.' || signed_exponent;
        });
    }
    kind = Token::Kind::sign;
    return at + 1;
}

}  // namespace

std::vector<Token> tokens_of(std::string_view text) {
    std::vector<Token> tokens;
    std::size_t line = 1, line_begin = 0;
    bool first_of_line = true, in_directive = false;
    const auto new_line = [&](std::size_t newline) {
        ++line;
        line_begin = newline + 1;
    };
    for (std::size_t at = 0; at < text.size();) {
        if (text[at] == '\n') {
            const std::string_view before = text.substr(0, at);
            if (!before.ends_with('\\') && !before.ends_with("\\\r")) in_directive = false;
            new_line(at++);
            first_of_line = true;
            continue;
        }
        if (std::isspace(static_cast<unsigned char>(text[at])) != 0) {
            ++at;
            continue;
        }
        Token token{
            .kind = {}, .text = {}, .offset = at, .line = line, .column = at - line_begin + 1, .in_directive = {}};
        const std::size_t end = end_of(text, at, token.kind);
        token.text = text.substr(at, end - at);
        if (first_of_line && token.text == "#") in_directive = true;
        token.in_directive = in_directive;
        if (token.kind != Token::Kind::comment) first_of_line = false;
        for (std::size_t i = at; i < end; ++i) {
            if (text[i] == '\n') new_line(i);
        }
        tokens.push_back(token);
        at = end;
    }
    return tokens;
}

std::vector<Token> code_tokens(const std::vector<Token>& all) {
    std::vector<Token> code;
    std::ranges::copy_if(all, std::back_inserter(code),
                         [](const Token& t) { return t.kind != Token::Kind::comment && !t.in_directive; });
    return code;
}

std::string place_in(std::string_view text, std::size_t offset) {
    const std::string_view before = text.substr(0, offset);
    const std::size_t newline = before.rfind('\n');
    const auto line = 1 + std::ranges::count(before, '\n');
    return std::to_string(line) + ":" +
           std::to_string(newline == std::string_view::npos ? offset + 1 : offset - newline);
}

}  // namespace lostbits::intersect::shader
