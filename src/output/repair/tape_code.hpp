// Writes a tape as statements of any language: decides which operations have statements of their own, and their names.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/table/table.hpp"
#include "number/tape.hpp"
#include "output/attribution/tape_slice.hpp"

namespace lostbits::output::repair {

using intersect::table::Intersector;

/// Prefix of the numbers of the primitive in a language, and names that the code must not use there.
struct LanguageNames {
    std::string primitive;  ///< prefix of names such as `centre.x`
    std::set<std::string, std::less<>> reserved;
};

/// Names of the inputs on the tape of a form: of a ray, of a primitive, and of its matrix if it has one.
std::vector<std::string> input_names_of(const Intersector& form);

class TapeCode {
public:
    virtual ~TapeCode() = default;
    TapeCode(const TapeCode&) = delete;
    TapeCode& operator=(const TapeCode&) = delete;

    /// Statements of the operations that are not written inside another expression, in order.
    [[nodiscard]] std::vector<std::string> statements() const;
    /// Node i as an operand, in parentheses if its expression binds less tightly than `binds`.
    [[nodiscard]] std::string operand(NodeId i, int binds) const;

protected:
    /// Code for everything that `outputs` are computed from. Operations without a name of their own have the names of
    /// the equal operations in `reference`.
    TapeCode(const Tape& tape, const Intersector& form, std::vector<NodeId> outputs, LanguageNames language,
             const TapeCode* reference = nullptr);

    [[nodiscard]] virtual std::string statement(NodeId i) const = 0;
    [[nodiscard]] virtual std::string expression(NodeId i) const = 0;
    [[nodiscard]] virtual std::string constant(NodeId i) const = 0;
    /// Precedence of the node's expression.
    [[nodiscard]] virtual int binding(NodeId i) const = 0;

    [[nodiscard]] bool is_wide(NodeId i) const { return tape_.format_of(i) != own_format_; }
    [[nodiscard]] const std::string& name(NodeId i) const { return names_[static_cast<std::size_t>(i)]; }

    const Tape& tape_;

private:
    void assign_names(const TapeCode* reference);
    std::string name_operation(const TapeNode& n, const TapeCode* reference, std::set<std::string>& used);
    /// Key of an operation: its name and the names of its operands.
    [[nodiscard]] std::string key_of(const TapeNode& n) const;
    /// Name of a difference of two inputs: `o_minus_centre_x` for `o.x - centre.x`; empty for other operations.
    [[nodiscard]] std::string input_difference_name(const TapeNode& n) const;
    [[nodiscard]] std::string identifier(std::string_view label) const;
    /// Number of operations that use a result. A conversion counts as often as its own result is used.
    [[nodiscard]] int uses(NodeId i) const;
    [[nodiscard]] bool is_inlined(NodeId i) const { return inlined_[static_cast<std::size_t>(i)]; }
    void choose_inlined();

    std::vector<NodeId> outputs_;
    attribution::TapeSlice slice_;
    LanguageNames language_;
    FloatFormat own_format_;
    std::vector<std::string> inputs_, names_;
    std::size_t primitive_numbers_;  ///< number of inputs after the ray; those of the matrix follow
    /// Names of operations without a label, by their key; equal operations are called by the first name.
    std::map<std::string, std::vector<std::string>> names_by_key_;
    std::vector<std::string> first_names_;
    int unnamed_ = 0;
    std::vector<bool> inlined_;
};

}  // namespace lostbits::output::repair
