#include "intersect/source_text/source_tokens.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>

namespace lostbits::intersect::source_text {
namespace {

constexpr std::size_t no_token = std::numeric_limits<std::size_t>::max();

bool is_word_character(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || (static_cast<unsigned char>(c) & 0x80U) != 0;
}

/// Length of the sign that begins a text.
std::size_t length_of_sign(std::string_view text) {
    constexpr std::array signs{"..=", "<<=", ">>=", "->", "=>", "::", "<=", ">=", "==", "!=", "&&", "||",
                               "+=",  "-=",  "*=",  "/=", "%=", "&=", "|=", "^=", "++", "--", "<<", ">>"};
    for (const std::string_view sign : signs)
        if (text.starts_with(sign)) return sign.size();
    return 1;
}

std::size_t length_of_word(std::string_view text) {
    const bool is_number = std::isdigit(static_cast<unsigned char>(text[0])) != 0;
    std::size_t n = 0;
    const auto is_exponent = [&](std::size_t k) {
        return is_number && k > 0 && (text[k - 1] == 'e' || text[k - 1] == 'E' || text[k - 1] == 'p') &&
               (text[k] == '+' || text[k] == '-');
    };
    while (n < text.size() && (is_word_character(text[n]) || (is_number && text[n] == '.') || is_exponent(n))) ++n;
    return n;
}

/// Length of the text in quotation marks that begins a text.
std::size_t length_of_quotation(std::string_view text) {
    std::size_t length = 1;
    while (length < text.size() && text[length] != '"') length += text[length] == '\\' ? 2 : 1;
    return std::min(length + 1, text.size());
}

/// Returns the end of the blank or the comment that begins at a position; the position itself if neither begins there.
std::size_t end_of_gap(std::string_view text, std::size_t position) {
    const std::string_view rest = text.substr(position);
    if (std::isspace(static_cast<unsigned char>(rest[0])) != 0) return position + 1;
    if (rest.starts_with("//")) return std::min(text.find('\n', position), text.size());
    if (!rest.starts_with("/*")) return position;
    const std::size_t end = text.find("*/", position + 2);
    return end == std::string_view::npos ? text.size() : end + 2;
}

/// How tightly a binary operator binds; 0 for a sign that ends expressions.
int precedence_of(std::string_view sign) {
    if (sign == "*" || sign == "/" || sign == "%") return 5;
    if (sign == "+" || sign == "-") return 4;
    if (sign == "<<" || sign == ">>" || sign == "&" || sign == "|" || sign == "^") return 3;
    if (sign == "<" || sign == ">" || sign == "<=" || sign == ">=" || sign == "==" || sign == "!=") return 2;
    return sign == "&&" || sign == "||" ? 1 : 0;
}

bool joins_names(std::string_view sign) { return sign == "." || sign == "->" || sign == "::"; }

bool is_keyword_before_expression(std::string_view word) {
    return word == "return" || word == "else" || word == "case" || word == "if";
}

}  // namespace

SourceTokens::SourceTokens(std::string_view text) : text_(text) {
    std::vector<std::size_t> open_brackets;
    for (std::size_t position = 0; position < text.size();) {
        if (const std::size_t end = end_of_gap(text, position); end > position) {
            position = end;
            continue;
        }

        const std::string_view rest = text.substr(position);
        const bool is_word = is_word_character(rest[0]) && rest[0] != '"';
        const std::size_t length = rest[0] == '"' ? length_of_quotation(rest)
                                   : is_word      ? length_of_word(rest)
                                                  : length_of_sign(rest);
        tokens_.push_back({position, position + length, is_word});
        const std::size_t k = tokens_.size() - 1;
        partner_index_.push_back(k);
        position += length;

        // Matches brackets.
        if (length != 1) continue;
        if (std::string_view("([{").find(rest[0]) != std::string_view::npos) open_brackets.push_back(k);
        if (std::string_view(")]}").find(rest[0]) != std::string_view::npos && !open_brackets.empty()) {
            partner_index_[k] = open_brackets.back();
            partner_index_[open_brackets.back()] = k;
            open_brackets.pop_back();
        }
    }
}

std::size_t SourceTokens::index_at(std::size_t offset) const {
    const auto found = std::ranges::upper_bound(tokens_, offset, {}, &Token::end);
    return found == tokens_.end() || found->begin > offset ? no_token
                                                           : static_cast<std::size_t>(found - tokens_.begin());
}

std::size_t SourceTokens::index_after(std::size_t k) const { return std::max(partner_index_[k], k) + 1; }
std::size_t SourceTokens::index_before(std::size_t k) const { return std::min(partner_index_[k], k) - 1; }

/// True for a sign in front of its only operand.
bool SourceTokens::is_prefix(std::size_t k) const {
    const std::string_view sign = text_of(k);
    if (sign == "!" || sign == "~") return true;
    if (sign != "-" && sign != "+" && sign != "*" && sign != "&") return false;
    if (k == 0) return true;
    const std::string_view previous = text_of(k - 1);
    return tokens_[k - 1].is_word ? is_keyword_before_expression(previous) : previous != ")" && previous != "]";
}

/// Index after the operand that begins at token k: prefix signs, a name or a group, and the brackets and members that
/// follow it.
std::size_t SourceTokens::end_of_operand(std::size_t k) const {
    while (k < tokens_.size() && is_prefix(k)) ++k;
    if (k < tokens_.size()) k = index_after(k);
    while (k < tokens_.size()) {
        const std::string_view next = text_of(k);
        if (joins_names(next) && k + 1 < tokens_.size()) k += 2;
        else if (next == "(" || next == "[") k = index_after(k);
        else break;
    }
    return std::min(k, tokens_.size());
}

TextSpan SourceTokens::find_expression_at(std::size_t offset) const {
    const std::size_t k = index_at(offset);
    if (k == no_token) return {offset, offset + 1};
    const int own_precedence = precedence_of(text_of(k));
    if (own_precedence == 0 || is_prefix(k)) return operand_at(k);

    // To the left, up to an operator that binds less tightly.
    std::size_t begin = k, end = k + 1;
    for (std::size_t j = k; j-- > 0; j = begin) {
        const std::string_view text = text_of(j);
        const bool opens = text == "(" || text == "[" || text == "{";
        if (opens || is_keyword_before_expression(text)) break;
        if (is_binary_sign(j) && precedence_of(text) < own_precedence) break;
        if (text == "}" || text == "=") break;
        begin = std::min(partner_index_[j], j);
    }

    // To the right, up to an operator that binds no more tightly.
    while (end < tokens_.size()) {
        const std::string_view text = text_of(end);
        if (text == ")" || text == "]" || text == "}" || text == "{") break;
        if (is_binary_sign(end) && precedence_of(text) <= own_precedence) break;
        end = index_after(end);
    }
    return {tokens_[begin].begin, tokens_[std::min(end, tokens_.size()) - 1].end};
}

/// Returns the call or the operand that begins at token k; for a name that is not called, the name with its members.
TextSpan SourceTokens::operand_at(std::size_t k) const {
    const bool is_operand = tokens_[k].is_word || is_prefix(k) || text_of(k) == "(";
    const std::size_t end = is_operand ? end_of_operand(k) : k + 1;
    const bool is_call = end > k + 1 && text_of(end - 1) == ")";
    if (!tokens_[k].is_word || is_call) return {tokens_[k].begin, tokens_[end - 1].end};
    std::size_t name = k;
    while (name + 2 < tokens_.size() && joins_names(text_of(name + 1)) && tokens_[name + 2].is_word) name += 2;
    return {tokens_[k].begin, tokens_[name].end};
}

/// True for a sign between two operands, or after an expression; false for brackets and for signs inside names.
bool SourceTokens::is_binary_sign(std::size_t k) const {
    return !tokens_[k].is_word && partner_index_[k] == k && !joins_names(text_of(k)) && !is_prefix(k);
}

TextSpan SourceTokens::find_expression_from(std::size_t offset) const {
    const std::size_t begin = index_at(offset);
    if (begin == no_token) return {offset, offset + 1};
    std::size_t end = begin;
    while (end < tokens_.size()) {
        const std::string_view text = text_of(end);
        const bool ends_expression = is_binary_sign(end) && precedence_of(text) == 0;
        if (text == "{" || text == ")" || text == "]" || text == "}" || ends_expression) break;
        end = index_after(end);
    }
    return {tokens_[begin].begin, tokens_[std::max(end, begin + 1) - 1].end};
}

/// Index after the expression that begins at token k: before a comma, a semicolon or a bracket that closes.
std::size_t SourceTokens::end_of_value(std::size_t k) const {
    while (k < tokens_.size()) {
        const std::string_view text = text_of(k);
        if (text == "," || text == ";" || text == ")" || text == "]" || text == "}") break;
        k = index_after(k);
    }
    return k;
}

std::optional<TextSpan> SourceTokens::value_of(std::string_view name, std::size_t begin, std::size_t end) const {
    std::optional<TextSpan> value;
    for (std::size_t k = 0; k + 2 < tokens_.size(); ++k) {
        if (tokens_[k].begin < begin || tokens_[k].begin >= end || text_of(k) != name) continue;
        if (k > 0 && joins_names(text_of(k - 1))) continue;
        std::size_t equals = k + 1;
        if (text_of(equals) == ":" && k + 3 < tokens_.size()) equals += 2;  // Rust: name: f32 = …
        if (text_of(equals) != "=") continue;
        const std::size_t value_end = end_of_value(equals + 1);
        if (value || value_end == equals + 1) return {};
        value = TextSpan{tokens_[equals + 1].begin, tokens_[value_end - 1].end};
    }
    return value;
}

auto SourceTokens::statement_around(std::size_t offset) const -> Statement {
    std::size_t k = index_at(offset);
    if (k == no_token) return {offset, offset};
    while (k > 0) {
        const std::string_view previous = text_of(k - 1);
        const bool is_block = previous == "}" && text_of(k) != "else";
        if (previous == ";" || previous == "{" || is_block) break;
        k = index_before(k - 1) + 1;
    }
    return {tokens_[k].begin, k == 0 ? 0 : tokens_[k - 1].end};
}

bool SourceTokens::has_word(std::string_view word) const {
    for (std::size_t k = 0; k < tokens_.size(); ++k)
        if (text_of(k) == word) return true;
    return false;
}

}  // namespace lostbits::intersect::source_text
