#include "output/repair/form_code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>
#include <sstream>

#include "measure/attribution/operations.hpp"
#include "output/file/escape.hpp"
#include "output/repair/tape_code.hpp"

namespace lostbits::output::repair {

namespace {

/// Names that the code must not use: keywords of C++, and the functions and parameters of the code.
std::set<std::string, std::less<>> reserved_names_of_cpp(const ShapeRow& shape) {
    std::istringstream words(R"(
        o d T W ray tmax wide narrow min max abs matrix sqrt fma near far select square named copysign next_up next_down
        alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class
        co_await co_return co_yield compl concept const consteval constexpr constinit const_cast continue decltype
        default delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int
        long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register
        reinterpret_cast requires return short signed sizeof static static_assert static_cast struct switch template
        this thread_local throw true try typedef typeid typename union unsigned using virtual void volatile wchar_t
        while xor xor_eq)");
    std::set<std::string, std::less<>> reserved{std::istream_iterator<std::string>(words), {}};
    reserved.emplace(shape.name);
    return reserved;
}

class CppCode final : public TapeCode {
public:
    CppCode(const Tape& tape, const Intersector& form, const CppCode* reference = nullptr)
        : TapeCode(tape, form, {tape.outputs.hit, tape.outputs.t, tape.outputs.near, tape.outputs.far},
                   {fmt::format("{}.", row_of(form.shape).name), reserved_names_of_cpp(row_of(form.shape))},
                   reference) {}

    [[nodiscard]] std::vector<std::string> lines() const {
        std::vector<std::string> code_lines = statements();
        const auto [hit, t, near, far] = tape_.outputs;
        code_lines.push_back(fmt::format("return {{{}, {}, {}, {}}};", operand(hit, 0), operand(t, 0), operand(near, 0),
                                         operand(far, 0)));
        return code_lines;
    }

private:
    [[nodiscard]] bool is_square(const TapeNode& node) const {
        return node.op == TapeOp::mul && node.operands[0] == node.operands[1];
    }
    [[nodiscard]] std::string statement(NodeId i) const override {
        const TapeNode& n = tape_[i];
        const bool is_boolean = is_decision(n.op);
        const std::string type = is_boolean ? "auto" : is_wide(i) ? "W" : "T";
        const std::string value = n.label.empty() || is_boolean
                                      ? expression(i)
                                      : fmt::format("named({}, {})", file::c_string(n.label), expression(i));
        return fmt::format("const {} {} = {};", type, name(i), value);
    }
    [[nodiscard]] std::string constant(NodeId i) const override {
        return fmt::format("{}({})", is_wide(i) ? "W" : "T", static_cast<int>(tape_[i].operands[0]));
    }
    [[nodiscard]] int precedence(NodeId i) const override {
        const TapeNode& n = tape_[i];
        return n.op == TapeOp::convert || is_square(n) ? 4 : measure::attribution::text_of(n.op).precedence.value;
    }
    // C++ evaluates a sum or product without parentheses from left to right.
    [[nodiscard]] std::string expression(NodeId i) const override {
        const TapeNode& n = tape_[i];
        if (n.op == TapeOp::any) return operand(n.operands[0], 0);
        if (n.op == TapeOp::convert)
            return fmt::format("{}({})", is_wide(i) ? "wide" : "narrow", operand(n.operands[0], 0));
        if (is_square(n)) return fmt::format("square({})", operand(n.operands[0], 0));
        return measure::attribution::fill_pattern(
            measure::attribution::text_of(n.op).plain.text, [&](std::size_t k, int precedence) {
                return operand(n.operands[k], n.op == TapeOp::add && k == 1 ? 2 : is_decision(n.op) ? 1 : precedence);
            });
    }
};

std::string name_of_roots(intersect::Roots roots) {
    switch (roots) {
        case intersect::Roots::both: return "both";
        case intersect::Roots::near_only: return "near_only";
        case intersect::Roots::first_only: return "first_only";
        case intersect::Roots::none: return "none";
    }
    return "";
}

std::string info_members(const intersect::Info& info, const FormTexts& texts) {
    using namespace intersect;
    std::string text =
        fmt::format("        .name = {},\n        .title = {},\n        .source = {},\n", file::c_string(texts.name),
                    file::c_string(texts.title), file::c_string(texts.source));

    // Members with their default values are left out.
    const auto add = [&](bool is_needed, const std::string& line) {
        if (is_needed) text += "        " + line + ",\n";
    };
    add(info.direction == Direction::unit, ".direction = Direction::unit");
    add(info.roots != Roots::both, ".roots = Roots::" + name_of_roots(info.roots));
    add(info.touching == Touching::miss, ".touching = Touching::miss");
    add(info.at_origin != AtOrigin::hit,
        fmt::format(".at_origin = AtOrigin::{}", at_origin_names[static_cast<std::size_t>(info.at_origin)]));
    add(texts.is_binary32_only, ".formats = Formats::binary32_only");
    add(info.inside != Inside::usual,
        fmt::format(".inside = Inside::{}", inside_names[static_cast<std::size_t>(info.inside)]));
    add(info.facing != Facing::both,
        fmt::format(".facing = Facing::{}", facing_names[static_cast<std::size_t>(info.facing)]));
    add(info.endless, ".endless = true");
    return text;
}

}  // namespace

std::vector<std::string> statements(const Tape& tape, const Intersector& form, const Tape* reference) {
    if (!reference) return CppCode(tape, form).lines();
    const CppCode reference_code(*reference, form);
    return CppCode(tape, form, &reference_code).lines();
}

std::string head_comment(const FormTexts& texts) {
    std::string text;
    for (const std::string& line : texts.head_lines) text += "// " + file::line_comment(line) + "\n";
    return text;
}

namespace {

/// True for names that the struct cannot have: names of the types in its code, and names without a lowercase letter,
/// because many macros of the C library are in capitals.
bool is_reserved_type_name(const std::string& type) {
    static const std::set<std::string, std::less<>> reserved_names = [] {
        std::set<std::string, std::less<>> names{"Ray",   "Vec",       "Hit",      "Info",      "Primitive", "Range",
                                                 "Wider", "Direction", "Touching", "AtOrigin",  "Inside",    "Facing",
                                                 "Roots", "Key",       "ShapeRow", "Convention"};
        for (const ShapeRow& shape_row : shape_rows) {
            std::string name(shape_row.name);
            name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
            names.insert(std::move(name));
        }
        return names;
    }();
    return reserved_names.contains(type) ||
           std::ranges::none_of(type, [](char c) { return std::islower(static_cast<unsigned char>(c)) != 0; });
}

}  // namespace

std::string type_name(const std::string& form) {
    std::string name;
    bool starts_word = true;
    for (const char c : form) {
        if (std::isalnum(static_cast<unsigned char>(c)))
            name += starts_word ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        starts_word = std::isalnum(static_cast<unsigned char>(c)) == 0;
    }
    return is_reserved_type_name(name) ? name + "_" : name;
}

namespace {

/// Declarations of the wider type and of the conversions that the code uses.
std::string conversion_declarations(const std::string& body, const FormTexts& texts) {
    const auto uses = [&](const char* word) { return body.find(word) != std::string::npos; };
    std::string conversions;
    if (uses("W"))
        conversions += texts.uses_two_words ? "        using W = number::wide::TwoWords<T>;\n"
                                            : "        using W = typename Wider<T>::type;\n";
    if (uses("wide("))
        conversions += fmt::format("        const auto wide = [](const T& x) {{ return {}(x); }};\n",
                                   texts.uses_two_words ? "W" : "Wider<T>::widen");
    if (uses("narrow("))
        conversions += fmt::format("        const auto narrow = [](const W& x) {{ return {}; }};\n",
                                   texts.uses_two_words ? "T(x.hi)" : "Wider<T>::narrow(x)");
    return conversions;
}

}  // namespace

std::string form_header(const Tape& tape, const Intersector& form_row, const FormTexts& texts) {
    const ShapeRow& shape = row_of(form_row.shape);
    std::string primitive(shape.name);
    primitive.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(primitive.front())));

    // The statements of `intersect`, and the declarations before them.
    std::string body;
    for (const std::string& line : statements(tape, form_row)) body += "        " + line + "\n";
    std::string matrix;
    if (form_row.has_transform_method)
        matrix = "        const auto& [M00, M01, M02, M03, M10, M11, M12, M13, M20, M21, M22, M23] = matrix;\n";

    return fmt::format(
        "{}#pragma once\n\n{}#include \"intersect/info.hpp\"\n{}#include \"shapes/{}/{}.hpp\"\n\n"
        "namespace lostbits::intersect::{} {{\n\nstruct {} {{\n    static constexpr Info info{{\n{}    }};\n\n"
        "    template <Number T>\n    static Hit<T> intersect(const Ray<T>& ray, const {}<T>& {}{}{}) {{\n{}"
        "        const Vec<T>&o = ray.origin, &d = ray.direction;\n{}{}    }}\n}};\n\n}}  // namespace "
        "lostbits::intersect::{}\n",
        head_comment(texts), form_row.has_transform_method ? "#include <array>\n\n" : "",
        texts.uses_two_words ? "#include \"number/wide/two_words.hpp\"\n" : "", shape.name, shape.name, shape.name,
        type_name(texts.name.substr(texts.name.find('.') + 1)), info_members(*form_row.info, texts), primitive,
        shape.name, form_row.has_transform_method ? ", const std::array<T, 12>& matrix" : "",
        shape.takes_tmax ? ", const T& tmax" : "", conversion_declarations(body, texts), matrix, body, shape.name);
}

std::vector<std::string> changed_lines(const std::vector<std::string>& before, const std::vector<std::string>& after) {
    // common[i][j]: the largest number of lines that before[i..] and after[j..] share, in order
    std::vector<std::vector<std::size_t>> common(before.size() + 1, std::vector<std::size_t>(after.size() + 1));
    for (std::size_t i = before.size(); i-- > 0;)
        for (std::size_t j = after.size(); j-- > 0;)
            common[i][j] =
                before[i] == after[j] ? common[i + 1][j + 1] + 1 : std::max(common[i + 1][j], common[i][j + 1]);

    // Removed and added lines are collected until the next common line, and then written in pairs.
    std::vector<std::string> lines, removed, added;
    const auto write_changes = [&] {
        for (std::size_t k = 0; k < std::max(removed.size(), added.size()); ++k) {
            if (k < removed.size()) lines.push_back("- " + removed[k]);
            if (k < added.size()) lines.push_back("+ " + added[k]);
        }
        removed.clear();
        added.clear();
    };

    for (std::size_t i = 0, j = 0; i < before.size() || j < after.size();) {
        const bool has_before = i < before.size(), has_after = j < after.size();
        if (has_before && has_after && before[i] == after[j]) {
            write_changes();
            ++i;
            ++j;
        } else if (has_before && (!has_after || common[i + 1][j] >= common[i][j + 1])) {
            removed.push_back(before[i++]);
        } else {
            added.push_back(after[j++]);
        }
    }
    write_changes();
    return lines;
}

}  // namespace lostbits::output::repair
