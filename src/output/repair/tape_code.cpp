#include "output/repair/tape_code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "intersect/table/recording.hpp"

namespace lostbits::output::repair {

namespace {

/// Largest number of characters of an expression that is written inside another one.
constexpr std::size_t max_inlined_characters = 56;

/// Input of the primitive's first number on a tape; the origin and the direction of the ray come before it.
constexpr NodeId first_primitive_input = 6;

/// Prefixes of the names of operations without a label; a number follows.
constexpr std::string_view decision_prefix = "m", number_prefix = "s";

}  // namespace

std::vector<std::string> input_names_of(const Intersector& form) {
    Primitive<double> primitive(form.shape);
    if (form.has_transform_method) primitive.transform.emplace();
    return intersect::table::input_names(form, intersect::Target<double>(primitive));
}

TapeCode::TapeCode(const Tape& tape, const Intersector& form, std::vector<NodeId> outputs, LanguageNames language,
                   const TapeCode* reference)
    : tape_(tape),
      outputs_(std::move(outputs)),
      slice_(tape, outputs_),
      language_(std::move(language)),
      form_format_(tape.format_of(tape.outputs.t)),
      input_names_(input_names_of(form)),
      primitive_number_count_(row_of(form.shape).number_count) {
    assign_names(reference);
    choose_inlined();
}

std::vector<std::string> TapeCode::statements() const {
    std::vector<std::string> lines;
    for (NodeId i = 0; i < tape_.size(); ++i)
        if (slice_.is_needed(i) && !is_given(tape_[i].op) && !is_inlined(i)) lines.push_back(statement(i));
    return lines;
}

std::string TapeCode::operand(NodeId i, int min_precedence) const {
    const TapeNode& n = tape_[i];
    if (n.op == TapeOp::constant) return constant(i);
    if (n.op == TapeOp::input || !is_inlined(i)) return name(i);
    const std::string text = expression(i);
    return precedence(i) < min_precedence ? fmt::format("({})", text) : text;
}

std::string TapeCode::identifier(std::string_view label) const {
    std::string result;
    for (const char c : label) {
        if (c == '\'') result += "_prime";
        else if (c == '^') continue;
        else if (std::isalnum(static_cast<unsigned char>(c))) result += c;
        else if (!result.ends_with('_')) result += '_';  // GLSL reserves names with two adjacent underscores
    }
    if (result.empty() || std::isdigit(static_cast<unsigned char>(result.front()))) result.insert(0, "x");
    return language_.reserved.contains(result) ? result + "_" : result;
}

// Conversions get no names, so the names of other operations do not depend on which operations are wider.
void TapeCode::assign_names(const TapeCode* reference) {
    const auto first_matrix_input = static_cast<NodeId>(first_primitive_input + primitive_number_count_);
    std::set<std::string> used;
    if (reference)
        for (const auto& [key, names] : reference->names_by_key_) used.insert(names.begin(), names.end());
    for (NodeId i = 0; i < tape_.size(); ++i) {
        const TapeNode& n = tape_[i];
        std::string name;
        if (n.op == TapeOp::input) {
            name = input_names_.at(n.operands[0]);
            if (name == "ray.tmax") name = "tmax";
            else if (n.operands[0] >= first_primitive_input && n.operands[0] < first_matrix_input)
                name.insert(0, language_.primitive_prefix);
        } else if (n.op != TapeOp::constant && n.op != TapeOp::convert) {
            name = add_operation_name(n, reference, used);
        }
        names_.push_back(std::move(name));
        first_names_.resize(names_.size(), names_.back());
    }
}

std::string TapeCode::add_operation_name(const TapeNode& node, const TapeCode* reference, std::set<std::string>& used) {
    const std::string proper_name = !node.label.empty() ? identifier(node.label) : input_difference_name(node);
    const std::string key = make_key(node);
    std::string name = proper_name;
    if (std::vector<std::string>& equal_names = names_by_key_[key]; proper_name.empty()) {
        // The name of the equal operation of the reference, or the next number that is free.
        const auto reference_names = reference ? reference->names_by_key_.find(key) : names_by_key_.end();
        if (reference && reference_names != reference->names_by_key_.end() &&
            reference_names->second.size() > equal_names.size())
            name = reference_names->second[equal_names.size()];
        while (name.empty()) {
            name = fmt::format("{}{}", is_decision(node.op) ? decision_prefix : number_prefix, ++unnamed_count_);
            if (!used.insert(name).second) name.clear();
        }
        equal_names.push_back(name);
    } else {
        // A number tells operations of one name apart.
        const char* const separator = std::isdigit(static_cast<unsigned char>(proper_name.back())) != 0 ? "_" : "";
        for (int repetition = 2; !used.insert(name).second; ++repetition)
            name = fmt::format("{}{}{}", proper_name, separator, repetition);
    }
    first_names_.push_back(proper_name.empty() ? names_by_key_[key].front() : name);
    return name;
}

std::string TapeCode::make_key(const TapeNode& node) const {
    std::string text(name_of(node.op));
    for (NodeId operand : node.operands) {
        if (operand == no_node) continue;
        if (tape_[operand].op == TapeOp::convert) operand = tape_[operand].operands[0];
        const bool is_constant = tape_[operand].op == TapeOp::constant;
        text += " " + (is_constant ? fmt::format("{}", tape_[operand].operands[0]) : first_names_[operand]);
    }
    return text;
}

std::string TapeCode::input_difference_name(const TapeNode& node) const {
    if (node.op != TapeOp::sub) return "";
    std::array<std::string, 2> names;
    for (std::size_t k = 0; k < 2; ++k) {
        const TapeNode* operand = &tape_[node.operands[k]];
        if (operand->op == TapeOp::convert) operand = &tape_[operand->operands[0]];
        if (operand->op != TapeOp::input) return "";
        names[k] = input_names_.at(operand->operands[0]);
    }
    const auto dot = names[0].find('.');
    if (dot == std::string::npos || !names[1].ends_with(names[0].substr(dot))) return "";
    return fmt::format("{}_minus_{}_{}", names[0].substr(0, dot), names[1].substr(0, names[1].find('.')),
                       names[0].substr(dot + 1));
}

int TapeCode::count_uses(NodeId i) const {
    int count = 0;
    for (NodeId k = i + 1; k < tape_.size(); ++k) {
        if (!slice_.is_needed(k) || is_given(tape_[k].op)) continue;
        for (const NodeId operand : tape_[k].operands) {
            if (operand == i) count += tape_[k].op == TapeOp::convert ? count_uses(k) : 1;
        }
    }
    for (const NodeId output : outputs_)
        if (output == i) ++count;
    return count;
}

// Chooses the expressions that are written inside others. Lengths do not include types and conversions, so the choice
// does not depend on which operations are wider.
void TapeCode::choose_inlined() {
    std::vector<std::size_t> length;
    for (NodeId i = 0; i < tape_.size(); ++i) {
        const TapeNode& n = tape_[i];
        std::size_t character_count = is_given(n.op) ? std::max(name(i).size(), std::size_t{4}) : 0;
        for (const NodeId operand : n.operands) {
            if (is_given(n.op) || operand == no_node) continue;
            character_count += length[operand] + (n.op == TapeOp::convert ? 0 : 3);
        }
        const bool needs_no_statement = is_given(n.op) || n.op == TapeOp::convert;
        const bool fits_inside = n.label.empty() && character_count <= max_inlined_characters && count_uses(i) == 1 &&
                                 input_difference_name(n).empty();
        is_inlined_.push_back(needs_no_statement || fits_inside);
        length.push_back(is_inlined_.back() ? character_count : name(i).size());
    }
}

}  // namespace lostbits::output::repair
