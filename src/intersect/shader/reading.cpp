#include "intersect/shader/reading.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <map>
#include <span>
#include <utility>

namespace lostbits::intersect::shader {

namespace {

bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// End of the token that begins at `at`, which is not white space.
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

namespace {

constexpr std::array<std::string_view, 10> no_types{"const",    "highp",    "mediump",  "lowp",     "precise",
                                                    "coherent", "volatile", "restrict", "readonly", "writeonly"};
constexpr std::array<std::string_view, 3> qualifiers{"in", "out", "inout"};

/// One parameter from its tokens, without the comma.
Parameter parameter_of(std::span<const Token> words) {
    Parameter p;
    for (const Token& word : words) {
        if (const auto qualifier = std::ranges::find(qualifiers, word.text); qualifier != qualifiers.end())
            p.qualifier = static_cast<Parameter::Qualifier>(qualifier - qualifiers.begin());
        else if (std::ranges::find(no_types, word.text) != no_types.end()) continue;
        else if (word.kind != Token::Kind::name) p.type += word.text;
        else (p.type.empty() ? p.type : p.name) = word.text;
    }
    return p;
}

/// For each index with an opening round bracket, the index of the closing one; `code.size()` if there is none.
std::vector<std::size_t> closings(const std::vector<Token>& code) {
    std::vector<std::size_t> closing(code.size(), code.size()), open;
    for (std::size_t i = 0; i < code.size(); ++i) {
        if (code[i].text == "(") open.push_back(i);
        if (code[i].text != ")" || open.empty()) continue;
        closing[open.back()] = i;
        open.pop_back();
    }
    return closing;
}

std::vector<Parameter> parameters_of(const std::vector<Token>& code, std::size_t begin, std::size_t end) {
    std::vector<Parameter> all;
    for (std::size_t i = begin; i < end;) {
        std::size_t comma = i;
        while (comma < end && code[comma].text != ",") ++comma;
        all.push_back(parameter_of(std::span(code).subspan(i, comma - i)));
        i = comma + 1;
    }
    if (all.size() == 1 && all.front().type == "void") all.clear();
    return all;
}

}  // namespace

std::string Function::words() const {
    constexpr std::array<std::string_view, 3> before{"", "out ", "inout "};
    std::string text = type + " " + name + "(";
    for (const Parameter& p : parameters) {
        if (&p != &parameters.front()) text += ", ";
        text +=
            std::string(before[static_cast<std::size_t>(p.qualifier)]) + p.type + (p.name.empty() ? "" : " " + p.name);
    }
    return text + ")";
}

std::vector<Function> functions_of(const std::vector<Token>& code) {
    std::vector<Function> all;
    const std::vector<std::size_t> closing = closings(code);
    int depth = 0;
    for (std::size_t i = 0; i < code.size(); ++i) {
        if (code[i].text == "{") ++depth;
        if (code[i].text == "}") --depth;
        const bool named = depth == 0 && i + 2 < code.size() && code[i].kind == Token::Kind::name &&
                           code[i + 1].kind == Token::Kind::name && code[i + 2].text == "(";
        if (!named) continue;
        const std::size_t end = closing[i + 2];
        if (end + 1 >= code.size() || code[end + 1].text != "{") continue;
        all.push_back({std::string(code[i].text), std::string(code[i + 1].text), parameters_of(code, i + 3, end),
                       code[i + 1].line, code[i + 1].column});
        i = end;
    }
    return all;
}

namespace {

/// Names that a #define, an int or a uint gives a whole number.
std::map<std::string_view, long long> whole_constants(const std::vector<Token>& tokens) {
    std::map<std::string_view, long long> found;
    for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
        const bool defined = tokens[i].in_directive && tokens[i].text == "define";
        const bool constant =
            (tokens[i].text == "int" || tokens[i].text == "uint") && i + 3 < tokens.size() && tokens[i + 2].text == "=";
        if (!defined && !constant) continue;
        const Token& value = tokens[i + (defined ? 2 : 3)];
        if (value.kind == Token::Kind::number && value.text.find_first_of(".xX") == std::string_view::npos)
            found[tokens[i + 1].text] = std::atoll(std::string(value.text).c_str());
    }
    return found;
}

/// For each index in the code, the ends of what begins there; the size of the code if it does not end. They are
/// computed in one pass, so that even a file of nothing but brackets takes linear time.
struct Ends {
    std::vector<std::size_t> bracket;    ///< index after the closing bracket; for other tokens the next index
    std::vector<std::size_t> semicolon;  ///< the next semicolon from here on
    std::vector<std::size_t>
        statement;  ///< index after the statement that begins here: a block, or up to the next semicolon

    explicit Ends(const std::vector<Token>& code) : semicolon(code.size() + 1, code.size()), statement(semicolon) {
        std::vector<std::size_t> open;
        for (std::size_t i = 0; i < code.size(); ++i) {
            const std::string_view t = code[i].text;
            bracket.push_back(t == "(" || t == "{" ? code.size() : i + 1);
            if (t == "(" || t == "{") open.push_back(i);
            if ((t != ")" && t != "}") || open.empty()) continue;
            bracket[open.back()] = i + 1;
            open.pop_back();
        }
        for (std::size_t i = code.size(); i-- > 0;) {
            semicolon[i] = code[i].text == ";" ? i : semicolon[i + 1];
            statement[i] = std::min(semicolon[i] + 1, code.size());
            if (code[i].text == "{") statement[i] = bracket[i];
            if (code[i].text == "for" && i + 1 < code.size()) statement[i] = statement[bracket[i + 1]];
        }
    }
};

/// True if a loop begins here whose condition never ends it: `while (true)`, `for (;;)`.
bool is_endless(const std::vector<Token>& code, const Ends& ends, std::size_t at) {
    if (code[at].text == "for") at = ends.semicolon[at];
    else if (code[at].text != "while") return false;
    if (at + 2 >= code.size()) return false;
    const bool says_true = code[at + 1].text == "true" || (code[at + 1].text == "(" && code[at + 2].text == "true");
    return says_true || (code[at].text == ";" && code[at + 1].text == ";");
}

/// The largest whole number between the `for` here and its second semicolon; 0 if there is none.
long long bound_of(const std::vector<Token>& code, std::size_t at,
                   const std::map<std::string_view, long long>& constants) {
    long long most = 0;
    int semicolons = 0;
    for (std::size_t k = at + 1; k < code.size() && semicolons < 2 && code[k].text != "for"; ++k) {
        semicolons += code[k].text == ";";
        const auto constant = constants.find(code[k].text);
        if (constant != constants.end()) most = std::max(most, constant->second);
        if (code[k].kind == Token::Kind::number && code[k].text.find('.') == std::string_view::npos)
            most = std::max(most, std::atoll(std::string(code[k].text).c_str()));
    }
    return std::min(most, 1'000'000'000LL);
}

}  // namespace

std::vector<CountedLoop> loops_of(const std::vector<Token>& all, const std::vector<Token>& code) {
    const auto constants = whole_constants(all);
    const Ends ends(code);
    std::vector<CountedLoop> loops;
    std::vector<std::pair<std::size_t, long long>>
        around;  // end of each enclosing loop, and the product of their counts
    for (std::size_t i = 0; i + 1 < code.size(); ++i) {
        while (!around.empty() && around.back().first <= i) around.pop_back();
        if (is_endless(code, ends, i)) loops.push_back({code[i].line, CountedLoop::endless, CountedLoop::endless});
        if (code[i].text != "for") continue;
        const long long most = bound_of(code, i, constants);
        if (most <= 0) continue;
        constexpr long long largest = 1'000'000'000'000LL;
        const auto [end, times] = around.empty() ? std::pair(code.size(), 1LL) : around.back();
        const long long together = times > largest / most ? largest : most * times;
        loops.push_back({code[i].line, most, together});
        around.emplace_back(std::min(ends.statement[i], end), together);
    }
    return loops;
}

}  // namespace lostbits::intersect::shader
