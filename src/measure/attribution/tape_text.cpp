#include "measure/attribution/tape_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "measure/attribution/operations.hpp"

namespace lostbits::measure::attribution {
namespace {

constexpr std::size_t max_inline_length =
    40;  ///< longest expression, in characters, that is written out within another expression

/// Name without its component, such as `o` for `o.x`; empty if the name has no component.
std::string vector_name(const std::string& name) {
    const auto n = name.size();
    return n > 2 && name[n - 2] == '.' && name[n - 1] >= 'x' && name[n - 1] <= 'z' ? name.substr(0, n - 2) : "";
}

std::string bracket(const std::string& text) {
    std::string bracketed = "(";
    return bracketed.append(text).append(")");
}

/// True for a word with another meaning in a program that `explain` writes: in C, in FPCore, or among its own
/// functions.
bool is_reserved(std::string_view word) {
    static constexpr std::array<std::string_view, 42> reserved{
        "auto",   "break",   "case",     "char",   "const",   "continue", "default", "do",      "double",
        "else",   "enum",    "extern",   "float",  "for",     "if",       "int",     "let",     "long",
        "return", "short",   "static",   "struct", "switch",  "void",     "while",   "main",    "printf",
        "fabs",   "fma",     "fmin",     "fmax",   "sqrt",    "copysign", "isnan",   "signbit", "nextafter",
        "sum",    "product", "quotient", "root",   "rounded", "show"};
    return std::ranges::find(reserved, word) != reserved.end();
}

}  // namespace

TapeText::TapeText(const Tape& tape, std::vector<std::string> inputs, TextStyle style)
    : tape_(tape),
      inputs_(std::move(inputs)),
      style_(style),
      names_(tape.nodes.size()),
      number_texts_(tape.nodes.size()),
      expressions_(tape.nodes.size()),
      dot_of_part_(tape.nodes.size(), no_node) {
    for (NodeId i = 0; i < tape.size(); ++i) {
        if (tape[i].op == TapeOp::input) names_[i] = inputs_.at(tape[i].operands[0]);
    }
    for (NodeId i = 0; i < tape.size(); ++i) {
        Dot dot;
        if (!find_dot(i, dot)) continue;
        name_vector(dot.a);
        name_vector(dot.b);
        const TapeNode& last = tape[i];
        const TapeNode& first = tape[last.operands[0]];
        for (const NodeId part : {i, last.operands[0], last.operands[1], first.operands[0], first.operands[1]})
            dot_of_part_[part] = i;
    }
    if (style == TextStyle::pretty) find_numbers();
    name_all_nodes();
}

/// Finds the operations by which a written formula builds its constants: m·2^e, from an integer m of 20 bits. In double
/// each of these operations is exact.
void TapeText::find_numbers() {
    constexpr int min_piece = 1 << 19;
    struct Number {
        bool is_known = false;
        bool has_piece = false;  ///< true if an integer m is part of it
        double value = 0;
    };
    std::vector<Number> numbers(tape_.nodes.size());
    for (NodeId i = 0; i < tape_.size(); ++i) {
        const TapeNode& n = tape_[i];
        Number& number = numbers[i];
        if (n.op == TapeOp::constant) {
            number = {true, n.operands[0] >= min_piece, static_cast<double>(n.operands[0])};
            continue;
        }

        // Computes negations, sums, products and quotients of known numbers.
        const auto side = [&](std::size_t k) { return numbers[n.operands[k]]; };
        if (n.op == TapeOp::neg) {
            number = side(0);
            number.value = -number.value;
        } else if (n.op == TapeOp::add || n.op == TapeOp::mul || n.op == TapeOp::div) {
            const Number a = side(0), b = side(1);
            number = {a.is_known && b.is_known, a.has_piece || b.has_piece,
                      n.op == TapeOp::add   ? a.value + b.value
                      : n.op == TapeOp::mul ? a.value * b.value
                                            : a.value / b.value};
        }

        if (!number.is_known || !number.has_piece || !std::isfinite(number.value)) continue;
        const auto narrow = static_cast<float>(number.value);
        number_texts_[i] = narrow == number.value ? fmt::format("{}", narrow) : fmt::format("{}", number.value);
    }
}

bool TapeText::is_vector(const Triple& v) const {
    const TapeOp op = tape_[v[0]].op;
    if (tape_[v[1]].op != op || tape_[v[2]].op != op || v[0] == v[1] || v[1] == v[2]) return false;
    if (op != TapeOp::input) return op != TapeOp::constant;
    const std::string base = vector_name(name(v[0]));
    return !base.empty() && name(v[0]) == base + ".x" && name(v[1]) == base + ".y" && name(v[2]) == base + ".z";
}

bool TapeText::find_dot(NodeId i, Dot& dot) const {
    const TapeNode& last = tape_[i];
    if (last.op != TapeOp::add) return false;
    const TapeNode& first = tape_[last.operands[0]];
    if (first.op != TapeOp::add || !first.label.empty()) return false;
    const std::array products{first.operands[0], first.operands[1], last.operands[1]};
    for (std::size_t k = 0; k < 3; ++k) {
        const TapeNode& product = tape_[products[k]];
        if (product.op != TapeOp::mul || !product.label.empty()) return false;
        dot.a[k] = product.operands[0];
        dot.b[k] = product.operands[1];
    }
    return is_vector(dot.a) && is_vector(dot.b);
}

void TapeText::name_vector(const Triple& v) {
    if (tape_[v[0]].op == TapeOp::input || vectors_.contains(v)) return;
    if (std::ranges::any_of(v, [&](NodeId i) { return !names_[i].empty() || !tape_[i].label.empty(); })) return;
    std::string base = "v";
    if (style_ != TextStyle::generic) base += std::to_string(vectors_.size() + 1);
    vectors_.emplace(v, base);
    for (std::size_t k = 0; k < 3; ++k) names_[v[k]] = base + "." + "xyz"[k];
}

void TapeText::name_all_nodes() {
    std::map<std::string, int> use_counts;
    for (const std::string& input : inputs_) ++use_counts[input];
    for (NodeId i = 0; i < tape_.size(); ++i) {
        const TapeNode& n = tape_[i];
        std::string& name = names_[i];
        if (n.op == TapeOp::constant) name = std::to_string(n.operands[0]);
        else if (n.label.empty() && is_number(i)) name = number_texts_[i];
        else if (!n.label.empty()) {
            name = n.label;
            if (const int use_count = ++use_counts[name]; use_count > 1 && style_ != TextStyle::generic) {
                const std::string base = vector_name(name), stem = base.empty() ? name : base;
                const bool is_number = std::isdigit(static_cast<unsigned char>(stem.back())) != 0;  // A^-1, not A^-12
                name = stem + (is_number ? "_" : "") + std::to_string(use_count) + name.substr(stem.size());
            }
        } else if (name.empty()) {
            name = (is_decision(n.op) ? "m" : "s") + std::to_string(i);
        }
    }
}

std::string TapeText::identifier(NodeId i) const {
    std::string id = name(i);
    if (tape_[i].op == TapeOp::constant) return id;
    std::string safe;
    for (const char c : id) {
        if (c == '\'') safe += "_prime";
        else safe += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    }
    if (std::isdigit(static_cast<unsigned char>(safe.front()))) safe.insert(0, "_");  // 1/det
    return is_reserved(safe) ? safe + "_" : safe;
}

/// True for a sum or difference of inputs, or for one input: short enough to replace a name.
bool TapeText::is_simple(NodeId i) const {
    const TapeNode& n = tape_[i];
    if (is_given(n.op)) return true;
    const auto has_name = [&](NodeId part) { return !tape_[part].label.empty() || tape_[part].op == TapeOp::input; };
    if (style_ == TextStyle::generic && n.label.empty() && (n.op == TapeOp::add || n.op == TapeOp::sub) &&
        has_name(n.operands[0]) && has_name(n.operands[1]))
        return true;
    return n.label.empty() && (n.op == TapeOp::add || n.op == TapeOp::sub) &&
           tape_[n.operands[0]].op == TapeOp::input && tape_[n.operands[1]].op == TapeOp::input;
}

std::string TapeText::vector_text(const Triple& v, bool without_brackets) const {
    const TapeNode& n = tape_[v[0]];
    if (n.op == TapeOp::input) return vector_name(name(v[0]));
    const auto known = vectors_.find(v);
    if (std::ranges::all_of(v, [&](NodeId i) { return is_simple(i); })) {
        const auto side = [&](std::size_t k) {
            return Triple{tape_[v[0]].operands[k], tape_[v[1]].operands[k], tape_[v[2]].operands[k]};
        };
        if (is_vector(side(0)) && is_vector(side(1))) {
            const std::string sign = n.op == TapeOp::add ? " + " : style_ == TextStyle::pretty ? " − " : " - ";
            const std::string text = vector_name(name(side(0)[0])) + sign + vector_name(name(side(1)[0]));
            return without_brackets ? text : bracket(text);
        }
    }
    if (known != vectors_.end()) return known->second;
    const std::string base = vector_name(name(v[0]));  // named by the formula, or by the watch of a march
    if (!base.empty() && vector_name(name(v[1])) == base && vector_name(name(v[2])) == base) return base;
    return bracket(name(v[0]) + ", " + name(v[1]) + ", " + name(v[2]));
}

std::string TapeText::operand(NodeId i, int precedence) const {
    const TapeNode& n = tape_[i];
    const std::string& node_name = name(i);
    if (n.op == TapeOp::input || !n.label.empty()) return node_name;
    if (n.op == TapeOp::constant || is_number(i))
        return node_name.starts_with('-') && precedence > 1 ? bracket(node_name) : node_name;
    if (!vector_name(name(i)).empty() && !is_simple(i)) return node_name;
    if (style_ == TextStyle::generic && !text_of(n.op).plain_in_loop.empty()) return "(...)";
    const std::string text = expression(i);
    Dot dot;
    const bool is_function = style_ == TextStyle::plain && find_dot(i, dot);
    if (text.size() > max_inline_length && !find_dot(i, dot)) return style_ == TextStyle::generic ? "(...)" : node_name;
    return !is_function && text_of(n.op).precedence.value < precedence ? bracket(text) : text;
}

std::string TapeText::write_out(NodeId i) const {
    const TapeNode& n = tape_[i];
    const auto pattern = [this](const OperationText& text) {
        switch (style_) {
            case TextStyle::pretty: return text.pretty.text;
            case TextStyle::generic: return text.plain_in_loop.empty() ? text.plain.text : text.plain_in_loop;
            case TextStyle::plain: break;
        }
        return text.plain.text;
    };
    return fill_pattern(pattern(text_of(n.op)),
                        [&](std::size_t k, int precedence) { return operand(n.operands[k], precedence); });
}

const std::string& TapeText::expression(NodeId i) const {
    std::string& text = expressions_[i];
    if (text.empty()) text = compose(i);
    return text;
}

std::string TapeText::compose(NodeId i) const {
    if (is_given(tape_[i].op)) return name(i);
    if (is_number(i)) return number_texts_[i];
    Dot dot;
    if (!find_dot(i, dot)) return write_out(i);
    if (style_ == TextStyle::pretty) return vector_text(dot.a, false) + "·" + vector_text(dot.b, false);
    return "dot(" + vector_text(dot.a, true) + ", " + vector_text(dot.b, true) + ")";
}

std::string TapeText::definition(NodeId i) const {
    const TapeNode& n = tape_[i];
    if (is_given(n.op)) return name(i);
    const bool has_name = !n.label.empty() || !vector_name(name(i)).empty();
    return has_name ? name(i) + " = " + expression(i) : expression(i);
}

std::string TapeText::category(NodeId i) const {
    // A label with spaces names a stretch of many operations (`Part`) and stands for all of them.
    const std::string_view label = tape_[i].label;
    if (label.find(' ') != std::string_view::npos) return std::string(label);
    const NodeId dot = dot_of_part_[i];
    const bool is_part = dot != no_node && dot != i;
    std::string text = is_part && tape_[i].op == TapeOp::add ? expression(dot) + ", its sums" : definition(i);
    // One axis stands for all three, and the first round of a loop for all rounds.
    std::string category_text;
    for (std::size_t k = 0; k < text.size(); ++k) {
        const bool is_component = k + 2 >= text.size() || !std::isalnum(static_cast<unsigned char>(text[k + 2]));
        if (text[k] == '.' && k + 1 < text.size() && text[k + 1] >= 'x' && text[k + 1] <= 'z' && is_component) {
            category_text += ".i";
            ++k;
        } else {
            category_text += text[k];
        }
    }
    return category_text;
}

}  // namespace lostbits::measure::attribution
