#include "scene/toml/quantity.hpp"

#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "number/rounded.hpp"
#include "scene/toml/parse_number.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::toml {
namespace {

bool is_part_of_a_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.'; }

/// Returns the text without the spaces around its operators; "1 2" is not twelve.
std::string text_without_spaces(const Node& node) {
    if (node.kind == Node::Kind::integer) return std::to_string(node.integer);
    if (node.kind != Node::Kind::string && node.kind != Node::Kind::floating)
        fail(node.where, "is " + node.describe() + " where a number or a string is expected");
    std::string text;
    bool after_space = false;
    for (const char c : node.text) {
        if (std::isspace(static_cast<unsigned char>(c)) != 0) {
            after_space = true;
            continue;
        }
        if (after_space && !text.empty() && is_part_of_a_word(text.back()) && is_part_of_a_word(c))
            fail(node.where, "\"" + node.text + "\" contains a space inside a number or word; remove it");
        after_space = false;
        text += c;
    }
    return text;
}

/// ⌊n/d⌋, also for negative n.
int floor_quotient(int n, int d) { return n / d - (n % d < 0 ? 1 : 0); }

bool remove_ending(std::string& text, std::string_view ending) {
    if (!text.ends_with(ending)) return false;
    text.erase(text.size() - ending.size());
    return true;
}

}  // namespace

bool Exponent::read_special_value(std::string_view text, std::size_t& position, Term& term) {
    using SpecialValue = Term::SpecialValue;
    constexpr std::pair<std::string_view, SpecialValue> words[] = {
        {"emax", SpecialValue::emax}, {"emin", SpecialValue::emin}, {"p", SpecialValue::p}};
    for (const auto& [name, word] : words) {
        if (!text.substr(position).starts_with(name)) continue;
        term.word = word;
        position += name.size();
        return true;
    }
    return false;
}

Exponent::Exponent(const Node& node) {
    const std::string text = text_without_spaces(node);
    const auto fail_malformed = [&] {
        fail(node.where,
             "\"" + text +
                 "\" is not an exponent; write a sum of whole numbers, emax, emin and p, each optionally divided by 2 "
                 "or 4, such as \"emax/2 + 1\"");
    };

    std::size_t position = 0;
    while (position < text.size()) {
        // The sign, which only the first term may lack.
        Term term{1, 0, Term::SpecialValue::none, 1};
        if (text[position] == '+' || text[position] == '-') term.sign = text[position++] == '-' ? -1 : 1;
        else if (position > 0) fail_malformed();

        // A parameter of the format, or a number.
        if (!read_special_value(text, position, term)) {
            const char* const begin = text.data() + position;
            const auto [stop, error] = std::from_chars(begin, text.data() + text.size(), term.number);
            if (error != std::errc{} || term.number < 0 || term.number > 10000) fail_malformed();
            position += static_cast<std::size_t>(stop - begin);
        }

        if (text.compare(position, 2, "/2") == 0 || text.compare(position, 2, "/4") == 0) {
            term.divisor = text[position + 1] - '0';
            position += 2;
        }
        terms_.push_back(term);
    }
    constexpr std::size_t max_terms = 16;
    if (terms_.empty() || terms_.size() > max_terms) fail_malformed();
}

int Exponent::value_in(const FloatFormat& format) const {
    int sum = 0;
    for (const Term& t : terms_) {
        using W = Term::SpecialValue;
        const int n = t.word == W::emax   ? format.emax
                      : t.word == W::emin ? format.emin
                      : t.word == W::p    ? format.precision
                                          : t.number;
        sum += t.sign * floor_quotient(n, t.divisor);
    }
    return sum;
}

Quantity::Quantity(const Node& node, bool allows_special) {
    std::string text = text_without_spaces(node);
    if (remove_ending(text, "+ulp")) ulps_ = 1;
    else if (remove_ending(text, "-ulp")) ulps_ = -1;

    std::string_view rest = text;
    const bool has_sign = !rest.empty() && (rest.front() == '-' || rest.front() == '+');
    const bool is_negative = has_sign && rest.front() == '-';

    // A word stands for a number of the format.
    constexpr std::pair<std::string_view, SpecialValue> words[] = {{"nan", SpecialValue::nan},
                                                                   {"inf", SpecialValue::inf},
                                                                   {"max", SpecialValue::max},
                                                                   {"min", SpecialValue::min},
                                                                   {"tiny", SpecialValue::tiny}};
    for (const auto& [name, word] : words) {
        if (rest.substr(has_sign ? 1 : 0) != name) continue;
        if (!allows_special && (word == SpecialValue::nan || word == SpecialValue::inf))
            fail(node.where, "is " + std::string(name) + ", which is allowed in rays only; write a finite number");
        word_ = word;
        negative_ = is_negative;
        return;
    }

    const auto parsed = parse_number(rest);
    if (const auto* fault = std::get_if<NumberFault>(&parsed))
        fail(node.where, "\"" + text + "\" " + fault->why + "; or write max, min, tiny, nan or inf");
    base_ = std::get<Real>(parsed);
}

double Quantity::value_in(const FloatFormat& format, int exponent) const {
    double x = 0;
    switch (word_) {
        case SpecialValue::none: x = round_to_format(base_ == 0 ? base_ : Real(ldexp(base_, exponent)), format); break;
        case SpecialValue::nan: x = std::numeric_limits<double>::quiet_NaN(); break;
        case SpecialValue::inf: x = std::numeric_limits<double>::infinity(); break;
        case SpecialValue::max: x = std::ldexp(2 - std::ldexp(1.0, 1 - format.precision), format.emax); break;
        case SpecialValue::min: x = std::ldexp(1.0, format.emin); break;
        case SpecialValue::tiny: x = std::ldexp(1.0, format.emin - format.precision + 1); break;
    }
    if (negative_) x = -x;
    if (ulps_ > 0) return rounding::next_up(x, format);
    if (ulps_ < 0) return -rounding::next_up(-x, format);
    return x;
}

}  // namespace lostbits::scene::toml
