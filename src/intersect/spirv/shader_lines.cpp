#include "intersect/spirv/shader_lines.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "intersect/shader/kernel.hpp"
#include "intersect/shader/reading.hpp"

namespace lostbits::intersect::spirv {
namespace {

bool is_operator(std::string_view text) {
    constexpr std::array operators{"++", "--", "+=", "-=", "*=", "/=", "%=", "<=", ">=",  "==",
                                   "!=", "&&", "||", "^^", "<<", ">>", "&=", "|=", "<<=", ">>="};
    return std::ranges::find(operators, text) != operators.end();
}

/// The first character of the operator from which an instruction comes; 0 for a call or for an instruction without
/// operator.
char sign_of(std::string_view op) {
    struct Sign {
        std::string_view end;
        char sign;
    };
    constexpr std::array signs{Sign{"Add", '+'},         Sign{"Sub", '-'},        Sign{"Negate", '-'}, Sign{"Mul", '*'},
                               Sign{"Div", '/'},         Sign{"LessThan", '<'},   Sign{"Equal", '='},  Sign{"Mod", '%'},
                               Sign{"GreaterThan", '>'}, Sign{"TimesScalar", '*'}};
    if (op.ends_with("LessThanEqual")) return '<';
    if (op.ends_with("GreaterThanEqual")) return '>';
    if (op.ends_with("NotEqual")) return '!';
    if (op.find("Times") != std::string_view::npos) return '*';
    for (const Sign& s : signs)
        if (op.ends_with(s.end)) return s.sign;
    return 0;
}

std::string lower_case(std::string_view text) {
    std::string result;
    for (const char c : text) result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

/// True if `name` is the name in GLSL or HLSL of the extended instruction: `abs` for FAbs, `rsqrt` for InverseSqrt.
bool is_extended(std::string_view name, std::string_view extended) {
    const std::string extended_name = lower_case(extended), shader_name = lower_case(name);
    return shader_name == extended_name || shader_name == extended_name.substr(1) ||
           (shader_name == "rsqrt" && extended_name == "inversesqrt") ||
           (shader_name == "frac" && extended_name == "fract");
}

std::string main_function_of(device::Language language) {
    const bool is_hlsl = language == device::Language::hlsl;
    return "\n" + std::string(is_hlsl ? "[numthreads(1, 1, 1)]" : "layout(local_size_x = 1) in;") + " void " +
           device::entry_of(language) + "() {}\n";
}

}  // namespace

std::string write_program_with_user_lines(const std::string& text, device::Language language) {
    if (language == device::Language::hlsl) return text + main_function_of(language);
    const auto [head, body] = shader::embeddable_text(text);
    return head + "#line 1\n" + body + main_function_of(language);
}

std::string write_program_with_token_lines(const std::string& text, device::Language language, ShaderLines& lines) {
    const bool is_hlsl = language == device::Language::hlsl;
    const auto [head, body] = is_hlsl ? std::pair(std::string(), text) : shader::embeddable_text(text);
    std::string program = head;
    lines.tokens.assign(static_cast<std::size_t>(std::ranges::count(head, '\n')), TokenPlace());
    const auto begin_line = [&](const shader::Token& token) {
        if (!program.empty() && program.back() != '\n') program += '\n';
        lines.tokens.push_back({std::string(token.text), static_cast<int>(token.line), static_cast<int>(token.column)});
    };

    const std::vector<shader::Token> tokens = shader::split_into_tokens(body);
    std::size_t end = 0, line = 0, line_directive = 0;
    for (const shader::Token& token : tokens) {
        if (token.kind == shader::Token::Kind::comment) continue;
        if (token.in_directive && token.text == "#" && &token != &tokens.back() && (&token)[1].text == "line")
            line_directive = token.line;
        if (token.in_directive && token.line == line_directive) continue;  // lines are counted in the file itself

        // A directive is one line; a backslash at the end of a line joins the next line to it.
        if (token.in_directive) {
            if (token.line != line) begin_line(token);
            else if (token.offset > end) program += ' ';
            if (token.text != "\\") program += token.text;
            line = token.text == "\\" ? token.line + 1 : token.line;
            end = token.offset + token.text.size();
            continue;
        }

        // Signs that form an operator stay together; every other token begins a line.
        line = 0;
        std::string& last_text = lines.tokens.empty() ? program : lines.tokens.back().text;
        const bool continues_operator = token.kind == shader::Token::Kind::sign && end == token.offset &&
                                        is_operator(last_text + std::string(token.text));
        if (continues_operator) last_text += token.text;
        else begin_line(token);
        program += token.text;
        end = token.offset + token.text.size();
    }
    return program + main_function_of(language);
}

PlaceFinder::PlaceFinder(const ShaderLines& lines) : lines_(lines), opening_(lines.tokens.size(), 0) {
    std::vector<std::size_t> open_brackets;
    for (std::size_t k = 0; k < lines.tokens.size(); ++k) {
        opening_[k] = k;
        if (lines.tokens[k].text == "(") open_brackets.push_back(k);
        if (lines.tokens[k].text != ")" || open_brackets.empty()) continue;
        opening_[k] = open_brackets.back();
        open_brackets.pop_back();
    }
}

void PlaceFinder::visit(int line, int column) {
    current_place_ = {{}, line, column};
    if (lines_.tokens.empty()) return;
    token_ = static_cast<std::size_t>(std::max(line - 1, 0));
    if (token_ >= lines_.tokens.size()) token_ = 0;
    visited_.push_back(token_);
}

std::size_t PlaceFinder::name_of(std::size_t token) const {
    const std::size_t open = opening_[token];
    return open == token || open == 0 ? token : open - 1;
}

TokenPlace PlaceFinder::last_visited() const {
    return lines_.tokens.empty() ? current_place_ : lines_.tokens[name_of(token_)];
}

bool PlaceFinder::take_last(char sign, std::size_t& token) {
    for (std::size_t k = visited_.size(); k-- > 0;) {
        if (!lines_.tokens[visited_[k]].text.starts_with(sign)) continue;
        token = visited_[k];
        std::erase(visited_, token);
        return true;
    }
    return false;
}

/// Place of an operator in the current line of the text. The column is 0 if the line does not have exactly one of it.
TokenPlace PlaceFinder::place_in_line(char sign) const {
    TokenPlace place = current_place_;
    if (place.column > 0 || place.line < 1 || static_cast<std::size_t>(place.line) > lines_.lines.size()) return place;
    const std::string& line = lines_.lines[static_cast<std::size_t>(place.line) - 1];
    const std::size_t position = sign == 0 ? std::string::npos : line.find(sign);
    const bool is_only_one = position != std::string::npos && line.find(sign, position + 1) == std::string::npos;
    place.column = is_only_one ? static_cast<int>(position) + 1 : 0;
    return place;
}

TokenPlace PlaceFinder::place_of(std::string_view op, std::string_view extended) {
    const char sign = sign_of(op);
    if (lines_.tokens.empty()) return place_in_line(sign);

    std::size_t token = token_;
    if (sign != 0 && take_last(sign, token)) return lines_.tokens[token];

    // glslang gives a call of one argument the place of that argument, which stands in the brackets of the call.
    for (std::size_t k = token_; k > 0 && !extended.empty(); --k) {
        if (lines_.tokens[k].text == ")") k = std::max<std::size_t>(opening_[k], 1);
        else if (lines_.tokens[k].text == ";" || lines_.tokens[k].text == "{") break;
        if (is_extended(lines_.tokens[k - 1].text, extended) && lines_.tokens[k].text == "(")
            return lines_.tokens[k - 1];
    }
    return last_visited();
}

}  // namespace lostbits::intersect::spirv
