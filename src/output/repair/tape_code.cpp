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
constexpr std::size_t short_enough = 56;

}  // namespace

std::vector<std::string> input_names_of(const Intersector& form) {
    Primitive<double> primitive(form.shape);
    if (form.is_placed) primitive.placed.emplace();
    return intersect::table::input_names(form, intersect::Target<double>(primitive));
}

TapeCode::TapeCode(const Tape& tape, const Intersector& form, std::vector<NodeId> wanted, LanguageNames language,
                   const TapeCode* like)
    : tape_(tape),
      wanted_(std::move(wanted)),
      slice_(tape, wanted_),
      language_(std::move(language)),
      own_(tape.format_of(tape.outputs.t)),
      inputs_(input_names_of(form)),
      primitive_numbers_(row_of(form.shape).numbers) {
    name_all(like);
    choose_inlined();
}

std::vector<std::string> TapeCode::statements() const {
    std::vector<std::string> all;
    for (NodeId i = 0; i < tape_.size(); ++i)
        if (slice_.needs(i) && !is_given(tape_[i].op) && !is_inlined(i)) all.push_back(statement(i));
    return all;
}

std::string TapeCode::operand(NodeId i, int binds) const {
    const TapeNode& n = tape_[i];
    if (n.op == TapeOp::constant) return constant(i);
    if (n.op == TapeOp::input || !is_inlined(i)) return name(i);
    const std::string text = expression(i);
    return binding(i) < binds ? fmt::format("({})", text) : text;
}

std::string TapeCode::identifier(std::string_view label) const {
    std::string id;
    for (const char c : label) {
        if (c == '\'') id += "_prime";
        else if (c == '^') continue;
        else if (std::isalnum(static_cast<unsigned char>(c))) id += c;
        else if (!id.ends_with('_')) id += '_';  // GLSL reserves names that contain two in a row
    }
    if (id.empty() || std::isdigit(static_cast<unsigned char>(id.front()))) id.insert(0, "x");
    return language_.reserved.contains(id) ? id + "_" : id;
}

// Conversions get no names, so the names of other operations do not depend on which of them are wider.
void TapeCode::name_all(const TapeCode* like) {
    const auto first_of_matrix = static_cast<NodeId>(6 + primitive_numbers_);
    std::set<std::string> used;
    if (like)
        for (const auto& [text, names] : like->known_) used.insert(names.begin(), names.end());
    for (NodeId i = 0; i < tape_.size(); ++i) {
        const TapeNode& n = tape_[i];
        std::string name;
        if (n.op == TapeOp::input) {
            name = inputs_.at(static_cast<std::size_t>(n.operands[0]));
            if (name == "ray.tmax") name = "tmax";
            else if (n.operands[0] >= 6 && n.operands[0] < first_of_matrix) name.insert(0, language_.primitive);
        } else if (n.op != TapeOp::constant && n.op != TapeOp::convert) {
            name = new_name(n, like, used);
        }
        names_.push_back(std::move(name));
        first_names_.resize(names_.size(), names_.back());
    }
}

std::string TapeCode::new_name(const TapeNode& n, const TapeCode* like, std::set<std::string>& used) {
    const std::string given = !n.label.empty() ? identifier(n.label) : of_inputs(n), text = text_of(n);
    std::string name = given;
    if (std::vector<std::string>& alike = known_[text]; given.empty()) {
        const auto there = like ? like->known_.find(text) : known_.end();
        if (like && there != like->known_.end() && there->second.size() > alike.size())
            name = there->second[alike.size()];
        while (name.empty()) {
            name = fmt::format("{}{}", is_decision(n.op) ? "m" : "s", ++unnamed_);
            if (!used.insert(name).second) name.clear();
        }
        alike.push_back(name);
    } else {
        const char* const between = std::isdigit(static_cast<unsigned char>(given.back())) != 0 ? "_" : "";
        for (int again = 2; !used.insert(name).second; ++again) name = fmt::format("{}{}{}", given, between, again);
    }
    first_names_.push_back(given.empty() ? known_[text].front() : name);
    return name;
}

std::string TapeCode::text_of(const TapeNode& n) const {
    std::string text(name_of(n.op));
    for (NodeId operand : n.operands) {
        if (operand == no_node) continue;
        if (tape_[operand].op == TapeOp::convert) operand = tape_[operand].operands[0];
        const bool whole = tape_[operand].op == TapeOp::constant;
        text += " " + (whole ? fmt::format("{}", tape_[operand].operands[0])
                             : first_names_[static_cast<std::size_t>(operand)]);
    }
    return text;
}

std::string TapeCode::of_inputs(const TapeNode& n) const {
    if (n.op != TapeOp::sub) return "";
    std::array<std::string, 2> of;
    for (std::size_t k = 0; k < 2; ++k) {
        const TapeNode* from = &tape_[n.operands[k]];
        if (from->op == TapeOp::convert) from = &tape_[from->operands[0]];
        if (from->op != TapeOp::input) return "";
        of[k] = inputs_.at(static_cast<std::size_t>(from->operands[0]));
    }
    const auto dot = of[0].find('.');
    if (dot == std::string::npos || !of[1].ends_with(of[0].substr(dot))) return "";
    return fmt::format("{}_minus_{}_{}", of[0].substr(0, dot), of[1].substr(0, of[1].find('.')), of[0].substr(dot + 1));
}

int TapeCode::uses(NodeId i) const {
    int all = 0;
    for (NodeId k = i + 1; k < tape_.size(); ++k) {
        if (!slice_.needs(k) || is_given(tape_[k].op)) continue;
        for (const NodeId operand : tape_[k].operands) {
            if (operand == i) all += tape_[k].op == TapeOp::convert ? uses(k) : 1;
        }
    }
    for (const NodeId out : wanted_)
        if (out == i) ++all;
    return all;
}

// Chooses the expressions that are written inside others. Lengths leave out types and conversions, so the choice does
// not depend on which operations are wider.
void TapeCode::choose_inlined() {
    std::vector<std::size_t> length;
    for (NodeId i = 0; i < tape_.size(); ++i) {
        const TapeNode& n = tape_[i];
        std::size_t all = is_given(n.op) ? std::max(name(i).size(), std::size_t{4}) : 0;
        for (const NodeId operand : n.operands) {
            if (is_given(n.op) || operand == no_node) continue;
            all += length[static_cast<std::size_t>(operand)] + (n.op == TapeOp::convert ? 0 : 3);
        }
        const bool alone = is_given(n.op) || n.op == TapeOp::convert;
        const bool within = n.label.empty() && all <= short_enough && uses(i) == 1 && of_inputs(n).empty();
        inlined_.push_back(alone || within);
        length.push_back(inlined_.back() ? all : name(i).size());
    }
}

}  // namespace lostbits::output::repair
