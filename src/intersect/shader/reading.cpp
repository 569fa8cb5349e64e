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

/// Returns the end of the token that begins at `begin`, which is not white space, and sets the kind of the token.
std::size_t end_of(std::string_view text, std::size_t begin, Token::Kind& kind) {
    const auto end_while = [&](std::size_t end, auto belongs) {
        while (end < text.size() && belongs(end)) ++end;
        return end;
    };
    const auto in_name = [&](std::size_t i) { return begins_name(text[i]) || is_digit(text[i]); };

    // Comments
    if (text.substr(begin, 2) == "//") {
        kind = Token::Kind::comment;
        return std::min(text.find('\n', begin), text.size());
    }
    if (text.substr(begin, 2) == "/*") {
        kind = Token::Kind::comment;
        const std::size_t end = text.find("*/", begin + 2);
        return end == std::string_view::npos ? text.size() : end + 2;
    }

    // Names, numbers and signs
    if (begins_name(text[begin])) {
        kind = Token::Kind::name;
        return end_while(begin, in_name);
    }
    if (is_digit(text[begin]) || (text[begin] == '.' && begin + 1 < text.size() && is_digit(text[begin + 1]))) {
        kind = Token::Kind::number;
        const bool is_hex = text.substr(begin, 2) == "0x" || text.substr(begin, 2) == "0X";
        return end_while(begin, [&](std::size_t i) {
            const bool signed_exponent = (text[i] == '+' || text[i] == '-') && i > begin && !is_hex &&
                                         (text[i - 1] == 'e' || text[i - 1] == 'E');
            return in_name(i) || text[i] == '.' || signed_exponent;
        });
    }
    kind = Token::Kind::sign;
    return begin + 1;
}

}  // namespace

std::vector<Token> split_into_tokens(std::string_view text) {
    std::vector<Token> tokens;
    std::size_t line = 1, line_begin = 0;
    bool first_of_line = true, in_directive = false;
    const auto new_line = [&](std::size_t newline) {
        ++line;
        line_begin = newline + 1;
    };
    for (std::size_t position = 0; position < text.size();) {
        // A backslash at the end of a line continues the directive on the next line.
        if (text[position] == '\n') {
            const std::string_view preceding = text.substr(0, position);
            if (!preceding.ends_with('\\') && !preceding.ends_with("\\\r")) in_directive = false;
            new_line(position++);
            first_of_line = true;
            continue;
        }
        if (std::isspace(static_cast<unsigned char>(text[position])) != 0) {
            ++position;
            continue;
        }

        Token token{.kind = {},
                    .text = {},
                    .offset = position,
                    .line = line,
                    .column = position - line_begin + 1,
                    .in_directive = {}};
        const std::size_t end = end_of(text, position, token.kind);
        token.text = text.substr(position, end - position);

        // A directive begins with a # that only comments precede in its line.
        if (first_of_line && token.text == "#") in_directive = true;
        token.in_directive = in_directive;
        if (token.kind != Token::Kind::comment) first_of_line = false;

        // A comment may have several lines.
        for (std::size_t i = position; i < end; ++i) {
            if (text[i] == '\n') new_line(i);
        }
        tokens.push_back(token);
        position = end;
    }
    return tokens;
}

std::vector<Token> code_tokens(const std::vector<Token>& tokens) {
    std::vector<Token> code;
    std::ranges::copy_if(tokens, std::back_inserter(code),
                         [](const Token& token) { return token.kind != Token::Kind::comment && !token.in_directive; });
    return code;
}

namespace {

constexpr std::array<std::string_view, 10> type_modifiers{"const",    "highp",    "mediump",  "lowp",     "precise",
                                                          "coherent", "volatile", "restrict", "readonly", "writeonly"};
constexpr std::array<std::string_view, 3> qualifiers{"in", "out", "inout"};

/// Reads one parameter from its tokens, without the comma.
Parameter parameter_of(std::span<const Token> tokens) {
    Parameter p;
    for (const Token& token : tokens) {
        if (const auto qualifier = std::ranges::find(qualifiers, token.text); qualifier != qualifiers.end())
            p.qualifier = static_cast<Parameter::Qualifier>(qualifier - qualifiers.begin());
        else if (std::ranges::find(type_modifiers, token.text) != type_modifiers.end()) continue;
        else if (token.kind != Token::Kind::name) p.type += token.text;
        else (p.type.empty() ? p.type : p.name) = token.text;
    }
    return p;
}

/// For each index of an opening round bracket, the index of its closing bracket; `code.size()` if the bracket is never
/// closed.
std::vector<std::size_t> closing_brackets(const std::vector<Token>& code) {
    std::vector<std::size_t> closing(code.size(), code.size()), open_brackets;
    for (std::size_t i = 0; i < code.size(); ++i) {
        if (code[i].text == "(") open_brackets.push_back(i);
        if (code[i].text != ")" || open_brackets.empty()) continue;
        closing[open_brackets.back()] = i;
        open_brackets.pop_back();
    }
    return closing;
}

std::vector<Parameter> parameters_of(const std::vector<Token>& code, std::size_t begin, std::size_t end) {
    std::vector<Parameter> parameters;
    for (std::size_t i = begin; i < end;) {
        std::size_t comma = i;
        while (comma < end && code[comma].text != ",") ++comma;
        parameters.push_back(parameter_of(std::span(code).subspan(i, comma - i)));
        i = comma + 1;
    }
    if (parameters.size() == 1 && parameters.front().type == "void") parameters.clear();
    return parameters;
}

}  // namespace

std::string Function::declaration() const {
    constexpr std::array<std::string_view, 3> qualifier_text{"", "out ", "inout "};
    std::string text = type + " " + name + "(";
    for (const Parameter& parameter : parameters) {
        if (&parameter != &parameters.front()) text += ", ";
        text += std::string(qualifier_text[static_cast<std::size_t>(parameter.qualifier)]) + parameter.type +
                (parameter.name.empty() ? "" : " " + parameter.name);
    }
    return text + ")";
}

std::vector<Function> find_functions(const std::vector<Token>& code) {
    std::vector<Function> functions;
    const std::vector<std::size_t> closing = closing_brackets(code);
    int depth = 0;
    for (std::size_t i = 0; i < code.size(); ++i) {
        if (code[i].text == "{") ++depth;
        if (code[i].text == "}") --depth;
        const bool is_function = depth == 0 && i + 2 < code.size() && code[i].kind == Token::Kind::name &&
                                 code[i + 1].kind == Token::Kind::name && code[i + 2].text == "(";
        if (!is_function) continue;
        const std::size_t end = closing[i + 2];
        if (end + 1 >= code.size() || code[end + 1].text != "{") continue;
        functions.push_back({std::string(code[i].text), std::string(code[i + 1].text), parameters_of(code, i + 3, end),
                             code[i + 1].line, code[i + 1].column});
        i = end;
    }
    return functions;
}

namespace {

/// Names to which a #define, an int or a uint gives an integer value, and the value.
std::map<std::string_view, long long> integer_constants(const std::vector<Token>& tokens) {
    std::map<std::string_view, long long> constants;
    for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
        const bool is_define = tokens[i].in_directive && tokens[i].text == "define";
        const bool is_constant =
            (tokens[i].text == "int" || tokens[i].text == "uint") && i + 3 < tokens.size() && tokens[i + 2].text == "=";
        if (!is_define && !is_constant) continue;
        const Token& value = tokens[i + (is_define ? 2 : 3)];
        if (value.kind == Token::Kind::number && value.text.find_first_of(".xX") == std::string_view::npos)
            constants[tokens[i + 1].text] = std::atoll(std::string(value.text).c_str());
    }
    return constants;
}

/// For each token of the code, the indices at which the constructs that begin with the token end; the size of the code
/// if they do not end. The indices are computed in one pass, so that even a file of nothing but brackets takes linear
/// time.
struct EndIndices {
    std::vector<std::size_t> bracket;    ///< index after the closing bracket; for other tokens the next index
    std::vector<std::size_t> semicolon;  ///< index of the next semicolon, from this token on
    /// Index after the statement that begins here: a block, or up to the next semicolon.
    std::vector<std::size_t> statement;

    explicit EndIndices(const std::vector<Token>& code)
        : semicolon(code.size() + 1, code.size()), statement(semicolon) {
        std::vector<std::size_t> open_brackets;
        for (std::size_t i = 0; i < code.size(); ++i) {
            const std::string_view t = code[i].text;
            bracket.push_back(t == "(" || t == "{" ? code.size() : i + 1);
            if (t == "(" || t == "{") open_brackets.push_back(i);
            if ((t != ")" && t != "}") || open_brackets.empty()) continue;
            bracket[open_brackets.back()] = i + 1;
            open_brackets.pop_back();
        }
        for (std::size_t i = code.size(); i-- > 0;) {
            semicolon[i] = code[i].text == ";" ? i : semicolon[i + 1];
            statement[i] = std::min(semicolon[i] + 1, code.size());
            if (code[i].text == "{") statement[i] = bracket[i];
            if (code[i].text == "for" && i + 1 < code.size()) statement[i] = statement[bracket[i + 1]];
        }
    }
};

/// True if a loop begins at `index` whose condition never ends it: `while (true)`, `for (;;)`.
bool is_endless(const std::vector<Token>& code, const EndIndices& ends, std::size_t index) {
    if (code[index].text == "for") index = ends.semicolon[index];
    else if (code[index].text != "while") return false;
    if (index + 2 >= code.size()) return false;
    const bool is_true =
        code[index + 1].text == "true" || (code[index + 1].text == "(" && code[index + 2].text == "true");
    return is_true || (code[index].text == ";" && code[index + 1].text == ";");
}

/// The largest integer between the `for` at `index` and its second semicolon; 0 if no integer is written there.
long long bound_of(const std::vector<Token>& code, std::size_t index,
                   const std::map<std::string_view, long long>& constants) {
    long long largest = 0;
    int semicolons = 0;
    for (std::size_t k = index + 1; k < code.size() && semicolons < 2 && code[k].text != "for"; ++k) {
        semicolons += code[k].text == ";";
        const auto constant = constants.find(code[k].text);
        if (constant != constants.end()) largest = std::max(largest, constant->second);
        if (code[k].kind == Token::Kind::number && code[k].text.find('.') == std::string_view::npos)
            largest = std::max(largest, std::atoll(std::string(code[k].text).c_str()));
    }
    return std::min(largest, 1'000'000'000LL);
}

}  // namespace

std::vector<CountedLoop> find_counted_loops(const std::vector<Token>& tokens, const std::vector<Token>& code) {
    const auto constants = integer_constants(tokens);
    const EndIndices ends(code);
    std::vector<CountedLoop> loops;
    std::vector<std::pair<std::size_t, long long>>
        enclosing_loops;  // end of each enclosing loop, and the product of their counts
    for (std::size_t i = 0; i + 1 < code.size(); ++i) {
        while (!enclosing_loops.empty() && enclosing_loops.back().first <= i) enclosing_loops.pop_back();
        if (is_endless(code, ends, i)) loops.push_back({code[i].line, CountedLoop::endless, CountedLoop::endless});
        if (code[i].text != "for") continue;
        const long long bound = bound_of(code, i, constants);
        if (bound <= 0) continue;

        // A loop inside of others runs as often as they all do.
        constexpr long long max_total = 1'000'000'000'000LL;
        const auto [end, enclosing_total] =
            enclosing_loops.empty() ? std::pair(code.size(), 1LL) : enclosing_loops.back();
        const long long total = enclosing_total > max_total / bound ? max_total : bound * enclosing_total;
        loops.push_back({code[i].line, bound, total});
        enclosing_loops.emplace_back(std::min(ends.statement[i], end), total);
    }
    return loops;
}

}  // namespace lostbits::intersect::shader
