#include "intersect/spirv/shader_lines.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "intersect/shader/kernel.hpp"
#include "intersect/shader/reading.hpp"

namespace lostbits::intersect::spirv {
namespace {

bool is_operator(std::string_view text) {
    constexpr std::array all{"++", "--", "+=", "-=", "*=", "/=", "%=", "<=", ">=",  "==",
                             "!=", "&&", "||", "^^", "<<", ">>", "&=", "|=", "<<=", ">>="};
    return std::ranges::find(all, text) != all.end();
}

/// The first character of the operator that an instruction comes from; 0: it is a call or has none.
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

std::string small(std::string_view text) {
    std::string made;
    for (const char c : text) made += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return made;
}

/// True if `name` of GLSL or HLSL is the extended instruction: `abs` for FAbs, `rsqrt` for InverseSqrt.
bool is_extended(std::string_view name, std::string_view extended) {
    const std::string word = small(extended), own = small(name);
    return own == word || own == word.substr(1) || (own == "rsqrt" && word == "inversesqrt") ||
           (own == "frac" && word == "fract");
}

std::string main_of(device::Language language) {
    const bool is_hlsl = language == device::Language::hlsl;
    return "\n" + std::string(is_hlsl ? "[numthreads(1, 1, 1)]" : "layout(local_size_x = 1) in;") + " void " +
           device::entry_of(language) + "() {}\n";
}

}  // namespace

std::string whole_program(const std::string& text, device::Language language) {
    if (language == device::Language::hlsl) return text + main_of(language);
    const auto [head, body] = shader::without_kernel(text);
    return head + "#line 1\n" + body + main_of(language);
}

std::string split_program(const std::string& text, device::Language language, ShaderLines& lines) {
    const bool is_hlsl = language == device::Language::hlsl;
    const auto [head, body] = is_hlsl ? std::pair(std::string(), text) : shader::without_kernel(text);
    std::string program = head;
    lines.tokens.assign(static_cast<std::size_t>(std::ranges::count(head, '\n')), TokenPlace());
    const auto begin_line = [&](const shader::Token& t) {
        if (!program.empty() && program.back() != '\n') program += '\n';
        lines.tokens.push_back({std::string(t.text), static_cast<int>(t.line), static_cast<int>(t.column)});
    };
    const std::vector<shader::Token> tokens = shader::tokens_of(body);
    std::size_t end = 0, line = 0, line_directive = 0;
    for (const shader::Token& t : tokens) {
        if (t.kind == shader::Token::Kind::comment) continue;
        if (t.in_directive && t.text == "#" && &t != &tokens.back() && (&t)[1].text == "line") line_directive = t.line;
        if (t.in_directive && t.line == line_directive) continue;  // lines are those of the file itself
        // A directive is one line; a backslash at the end of a line joins the next one to it.
        if (t.in_directive) {
            if (t.line != line) begin_line(t);
            else if (t.offset > end) program += ' ';
            if (t.text != "\\") program += t.text;
            line = t.text == "\\" ? t.line + 1 : t.line;
            end = t.offset + t.text.size();
            continue;
        }
        line = 0;
        std::string& last = lines.tokens.empty() ? program : lines.tokens.back().text;
        const bool joins =
            t.kind == shader::Token::Kind::sign && end == t.offset && is_operator(last + std::string(t.text));
        if (joins) last += t.text;
        else begin_line(t);
        program += t.text;
        end = t.offset + t.text.size();
    }
    return program + main_of(language);
}

PlaceFinder::PlaceFinder(const ShaderLines& lines) : lines_(lines), opening_(lines.tokens.size(), 0) {
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < lines.tokens.size(); ++k) {
        opening_[k] = k;
        if (lines.tokens[k].text == "(") open.push_back(k);
        if (lines.tokens[k].text != ")" || open.empty()) continue;
        opening_[k] = open.back();
        open.pop_back();
    }
}

void PlaceFinder::visit(int line, int column) {
    now_ = {{}, line, column};
    if (lines_.tokens.empty()) return;
    token_ = static_cast<std::size_t>(std::max(line - 1, 0));
    if (token_ >= lines_.tokens.size()) token_ = 0;
    visited_.push_back(token_);
}

std::size_t PlaceFinder::name_of(std::size_t token) const {
    const std::size_t open = opening_[token];
    return open == token || open == 0 ? token : open - 1;
}

TokenPlace PlaceFinder::last() const { return lines_.tokens.empty() ? now_ : lines_.tokens[name_of(token_)]; }

bool PlaceFinder::take_last(char sign, std::size_t& token) {
    for (std::size_t k = visited_.size(); k-- > 0;) {
        if (!lines_.tokens[visited_[k]].text.starts_with(sign)) continue;
        token = visited_[k];
        std::erase(visited_, token);
        return true;
    }
    return false;
}

TokenPlace PlaceFinder::place_of(std::string_view op, std::string_view extended) {
    const char sign = sign_of(op);
    if (lines_.tokens.empty()) {
        TokenPlace found = now_;
        if (found.column > 0 || found.line < 1 || static_cast<std::size_t>(found.line) > lines_.lines.size())
            return found;
        const std::string& line = lines_.lines[static_cast<std::size_t>(found.line) - 1];
        std::size_t at = sign == 0 ? std::string::npos : line.find(sign);
        // With more than one such operator on the line, no one knows which of them it is.
        if (at != std::string::npos && line.find(sign, at + 1) != std::string::npos) at = std::string::npos;
        found.column = at == std::string::npos ? 0 : static_cast<int>(at) + 1;
        return found;
    }
    std::size_t token = token_;
    if (sign != 0 && take_last(sign, token)) return lines_.tokens[token];
    // glslang names a call of one argument by the place of that argument, which stands in its brackets.
    for (std::size_t k = token_; k > 0 && !extended.empty(); --k) {
        if (lines_.tokens[k].text == ")") k = std::max<std::size_t>(opening_[k], 1);
        else if (lines_.tokens[k].text == ";" || lines_.tokens[k].text == "{") break;
        if (is_extended(lines_.tokens[k - 1].text, extended) && lines_.tokens[k].text == "(")
            return lines_.tokens[k - 1];
    }
    return last();
}

}  // namespace lostbits::intersect::spirv
