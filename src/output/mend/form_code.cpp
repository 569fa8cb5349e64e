#include "output/mend/form_code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "intersect/table/recording.hpp"
#include "measure/blame/operations.hpp"
#include "output/blame/tape_slice.hpp"
#include "output/file/escape.hpp"

namespace lostbits::output::mend {

using intersect::table::Intersector;

namespace {

/// Letters of an expression that is written out within another, and of one that is alone.
constexpr std::size_t short_enough = 56;

std::string identifier(std::string_view label) {
    static const std::set<std::string, std::less<>> taken{
        "o",    "d",   "T",    "W",   "ray", "tmax", "wide", "narrow", "min",    "max",    "abs",
        "sqrt", "fma", "auto", "and", "or",  "not",  "near", "far",    "select", "square", "int"};
    std::string id;
    for (const char c : label) {
        if (c == '\'') id += "_prime";
        else if (c == '^') continue;
        else id += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    }
    if (id.empty() || std::isdigit(static_cast<unsigned char>(id.front()))) id.insert(0, "x");
    return taken.contains(id) ? id + "_" : id;
}

class Code {
public:
    /// `like`: what has no name of its own is called as it is there.
    Code(const Tape& tape, const Intersector& form, const Code* like = nullptr)
        : tape_(tape),
          slice_(tape, {tape.outputs.hit, tape.outputs.t, tape.outputs.near, tape.outputs.far}),
          shape_(row_of(form.shape).name),
          own_(tape.format_of(tape.outputs.t)) {
        Solid<double> solid(form.shape);
        inputs_ = intersect::table::input_names(form, intersect::Target<double>(solid));
        name_all(like);
        choose_inlined();
    }

    std::vector<std::string> lines() {
        std::vector<std::string> all;
        for (NodeId i = 0; i < tape_.size(); ++i) {
            if (!slice_.needs(i) || is_given(tape_[i].op) || is_inlined(i)) continue;
            const TapeNode& n = tape_[i];
            const bool decides = is_decision(n.op);
            const std::string type = decides ? "auto" : is_wide(i) ? "W" : "T";
            const std::string value =
                n.label.empty() || decides ? expression(i) : fmt::format("named(\"{}\", {})", n.label, expression(i));
            all.push_back(fmt::format("const {} {} = {};", type, name(i), value));
        }
        const auto [hit, t, near, far] = tape_.outputs;
        all.push_back(fmt::format("return {{{}, {}, {}, {}}};", operand(hit, 0), operand(t, 0), operand(near, 0),
                                  operand(far, 0)));
        return all;
    }

private:
    [[nodiscard]] bool is_wide(NodeId i) const { return tape_.format_of(i) != own_; }
    [[nodiscard]] const std::string& name(NodeId i) const { return names_[static_cast<std::size_t>(i)]; }

    /// Conversions have no names: the others are called alike with and without them.
    void name_all(const Code* like) {
        std::set<std::string> used;
        if (like)
            for (const auto& [text, names] : like->known_) used.insert(names.begin(), names.end());
        for (NodeId i = 0; i < tape_.size(); ++i) {
            const TapeNode& n = tape_[i];
            std::string name;
            if (n.op == TapeOp::input) {
                name = inputs_.at(static_cast<std::size_t>(n.operands[0]));
                if (name == "limit") name = "tmax";
                else if (n.operands[0] >= 6) name = fmt::format("{}.{}", shape_, name);
            } else if (n.op != TapeOp::constant && n.op != TapeOp::convert) {
                name = new_name(n, like, used);
            }
            names_.push_back(std::move(name));
            first_names_.resize(names_.size(), names_.back());
        }
    }
    std::string new_name(const TapeNode& n, const Code* like, std::set<std::string>& used) {
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
    /// What an operation does to which names.
    [[nodiscard]] std::string text_of(const TapeNode& n) const {
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
    /// `o.x - centre.x` as `o_minus_centre_x`.
    [[nodiscard]] std::string of_inputs(const TapeNode& n) const {
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
        return fmt::format("{}_minus_{}_{}", of[0].substr(0, dot), of[1].substr(0, of[1].find('.')),
                           of[0].substr(dot + 1));
    }

    /// The operations that take a result, conversions counted as what they convert.
    [[nodiscard]] int uses(NodeId i) const {
        int all = 0;
        for (NodeId k = i + 1; k < tape_.size(); ++k) {
            if (!slice_.needs(k) || is_given(tape_[k].op)) continue;
            for (const NodeId operand : tape_[k].operands) {
                if (operand == i) all += tape_[k].op == TapeOp::convert ? uses(k) : 1;
            }
        }
        for (const NodeId out : {tape_.outputs.hit, tape_.outputs.t, tape_.outputs.near, tape_.outputs.far})
            if (out == i) ++all;
        return all;
    }
    [[nodiscard]] bool is_inlined(NodeId i) const { return inlined_[static_cast<std::size_t>(i)]; }
    /// What stands within another expression: by lengths without what types and conversions add, and so the same
    /// whatever is wider.
    void choose_inlined() {
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

    /// Where sums and products of three stand without brackets, the first two are done first.
    [[nodiscard]] std::string expression(NodeId i) const {
        const TapeNode& n = tape_[i];
        if (n.op == TapeOp::any) return operand(n.operands[0], 0);
        if (n.op == TapeOp::convert)
            return fmt::format("{}({})", is_wide(i) ? "wide" : "narrow", operand(n.operands[0], 0));
        if (n.op == TapeOp::mul && n.operands[0] == n.operands[1])
            return fmt::format("square({})", operand(n.operands[0], 0));
        return measure::blame::filled(measure::blame::text_of(n.op).plain.text, [&](std::size_t k, int binds) {
            return operand(n.operands[k], n.op == TapeOp::add && k == 1 ? 2 : is_decision(n.op) ? 1 : binds);
        });
    }
    [[nodiscard]] std::string operand(NodeId i, int binds) const {
        const TapeNode& n = tape_[i];
        if (n.op == TapeOp::constant)
            return fmt::format("{}({})", is_wide(i) ? "W" : "T", static_cast<int>(n.operands[0]));
        if (n.op == TapeOp::input || !is_inlined(i)) return name(i);
        const bool call = n.op == TapeOp::convert || (n.op == TapeOp::mul && n.operands[0] == n.operands[1]);
        const std::string text = expression(i);
        return !call && measure::blame::text_of(n.op).binds.level < binds ? fmt::format("({})", text) : text;
    }

    const Tape& tape_;
    blame::TapeSlice slice_;
    std::string shape_;
    FloatFormat own_;
    std::vector<std::string> inputs_, names_;
    /// What the source gives no name: by what it is, and the first that is the same.
    std::map<std::string, std::vector<std::string>> known_;
    std::vector<std::string> first_names_;
    int unnamed_ = 0;
    std::vector<bool> inlined_;
};

std::string words_of(intersect::Roots roots) {
    switch (roots) {
        case intersect::Roots::both: return "both";
        case intersect::Roots::near_only: return "near_only";
        case intersect::Roots::first_only: return "first_only";
        case intersect::Roots::none: return "none";
    }
    return "";
}

std::string info_of(const intersect::Info& like, const FormWords& words) {
    using namespace intersect;
    std::string text = fmt::format("        .name = \"{}\",\n        .title = \"{}\",\n        .source = \"{}\",\n",
                                   words.name, words.title, words.source);
    const auto add = [&](bool differs, const std::string& line) {
        if (differs) text += "        " + line + ",\n";
    };
    add(like.direction == Direction::unit, ".direction = Direction::unit");
    add(like.roots != Roots::both, ".roots = Roots::" + words_of(like.roots));
    add(like.touching == Touching::miss, ".touching = Touching::miss");
    add(like.at_origin != AtOrigin::hit,
        fmt::format(".at_origin = AtOrigin::{}", at_origin_names[static_cast<std::size_t>(like.at_origin)]));
    add(words.binary32_only, ".formats = Formats::binary32_only");
    add(like.inside != Inside::usual,
        fmt::format(".inside = Inside::{}", inside_names[static_cast<std::size_t>(like.inside)]));
    add(like.endless, ".endless = true");
    return text;
}

}  // namespace

std::vector<std::string> statements(const Tape& tape, const Intersector& form, const Tape* like) {
    if (!like) return Code(tape, form).lines();
    const Code other(*like, form);
    return Code(tape, form, &other).lines();
}

std::string type_name(const std::string& form) {
    std::string name;
    bool up = true;
    for (const char c : form) {
        if (std::isalnum(static_cast<unsigned char>(c)))
            name += up ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        up = std::isalnum(static_cast<unsigned char>(c)) == 0;
    }
    return name;
}

std::string form_header(const Tape& tape, const Intersector& like, const FormWords& words) {
    const ShapeRow& shape = row_of(like.shape);
    std::string solid(shape.name);
    solid.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(solid.front())));
    std::string body;
    for (const std::string& line : statements(tape, like)) body += "        " + line + "\n";
    const auto uses = [&](const char* word) { return body.find(word) != std::string::npos; };
    std::string ways;
    if (uses("W"))
        ways += words.two_words ? "        using W = number::wide::TwoWords<T>;\n"
                                : "        using W = typename Wider<T>::type;\n";
    if (uses("wide("))
        ways += fmt::format("        const auto wide = [](const T& x) {{ return {}(x); }};\n",
                            words.two_words ? "W" : "Wider<T>::widen");
    if (uses("narrow("))
        ways += fmt::format("        const auto narrow = [](const W& x) {{ return {}; }};\n",
                            words.two_words ? "T(x.hi)" : "Wider<T>::narrow(x)");
    return fmt::format(
        "{}#pragma once\n\n#include \"intersect/info.hpp\"\n{}#include \"shapes/{}/{}.hpp\"\n\n"
        "namespace lostbits::intersect::{} {{\n\nstruct {} {{\n    static constexpr Info info{{\n{}    }};\n\n"
        "    template <Number T>\n    static Hit<T> intersect(const Ray<T>& ray, const {}<T>& {}{}) {{\n{}"
        "        const Vec<T>&o = ray.origin, &d = ray.direction;\n{}    }}\n}};\n\n}}  // namespace "
        "lostbits::intersect::{}\n",
        words.comment, words.two_words ? "#include \"number/wide/two_words.hpp\"\n" : "", shape.name, shape.name,
        shape.name, type_name(words.name.substr(words.name.find('.') + 1)), info_of(*like.info, words), solid,
        shape.name, shape.told_end ? ", const T& tmax" : "", ways, body, shape.name);
}

std::vector<std::string> changed_lines(const std::vector<std::string>& before, const std::vector<std::string>& after) {
    // common[i][j]: the most lines that before[i..] and after[j..] have in common, in order
    std::vector<std::vector<std::size_t>> common(before.size() + 1, std::vector<std::size_t>(after.size() + 1));
    for (std::size_t i = before.size(); i-- > 0;)
        for (std::size_t j = after.size(); j-- > 0;)
            common[i][j] =
                before[i] == after[j] ? common[i + 1][j + 1] + 1 : std::max(common[i + 1][j], common[i][j + 1]);
    std::vector<std::string> lines, old, now;
    const auto write = [&] {
        for (std::size_t k = 0; k < std::max(old.size(), now.size()); ++k) {
            if (k < old.size()) lines.push_back("- " + old[k]);
            if (k < now.size()) lines.push_back("+ " + now[k]);
        }
        old.clear(), now.clear();
    };
    for (std::size_t i = 0, j = 0; i < before.size() || j < after.size();) {
        const bool more_before = i < before.size(), more_after = j < after.size();
        if (more_before && more_after && before[i] == after[j]) write(), ++i, ++j;
        else if (more_before && (!more_after || common[i + 1][j] >= common[i][j + 1])) old.push_back(before[i++]);
        else now.push_back(after[j++]);
    }
    write();
    return lines;
}

}  // namespace lostbits::output::mend
