#include "intersect/shader/functions.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace lostbits::intersect::shader {
namespace {

constexpr std::array<std::string_view, 10> no_types{"const",    "highp",    "mediump",  "lowp",     "precise",
                                                    "coherent", "volatile", "restrict", "readonly", "writeonly"};
constexpr std::array<std::string_view, 3> ways{"in", "out", "inout"};

/// One parameter from its tokens, without the comma.
Parameter parameter_of(std::span<const Token> words) {
    Parameter p;
    for (const Token& word : words) {
        if (const auto way = std::ranges::find(ways, word.text); way != ways.end())
            p.way = static_cast<Parameter::Way>(way - ways.begin());
        else if (std::ranges::find(no_types, word.text) != no_types.end()) continue;
        else if (word.kind != Token::Kind::name) p.type += word.text;
        else (p.type.empty() ? p.type : p.name) = word.text;
    }
    return p;
}

/// For each place with a round bracket the place of the one that closes it; `code.size()` where none does.
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
        text += std::string(before[static_cast<std::size_t>(p.way)]) + p.type + (p.name.empty() ? "" : " " + p.name);
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

}  // namespace lostbits::intersect::shader
