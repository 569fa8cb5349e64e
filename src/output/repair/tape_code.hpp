// Writes a tape as statements of C++ or GLSL: decides which operations get a statement of their own, and names them.
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

/// Names in a target language.
struct LanguageNames {
    std::string primitive_prefix;  ///< stands before names of the primitive's numbers, such as `centre.x`
    std::set<std::string, std::less<>> reserved;  ///< names that the code must not use
};

/// Names of the inputs on the tape of a form: the numbers of the ray, of the primitive, and of its matrix if it has
/// one.
std::vector<std::string> input_names_of(const Intersector& form);

/// Base of the writers: derived classes write statements, expressions and constants of their language.
class TapeCode {
public:
    virtual ~TapeCode() = default;
    TapeCode(const TapeCode&) = delete;
    TapeCode& operator=(const TapeCode&) = delete;

    /// Statements of the operations that are not written inside another expression, in order.
    [[nodiscard]] std::vector<std::string> statements() const;
    /// Node i as an operand, in parentheses if the precedence of its expression is below `min_precedence`.
    [[nodiscard]] std::string operand(NodeId i, int min_precedence) const;

protected:
    /// Code for everything that `outputs` are computed from. Operations without a name of their own have the names of
    /// the equal operations in `reference`.
    TapeCode(const Tape& tape, const Intersector& form, std::vector<NodeId> outputs, LanguageNames language,
             const TapeCode* reference = nullptr);

    [[nodiscard]] virtual std::string statement(NodeId i) const = 0;
    [[nodiscard]] virtual std::string expression(NodeId i) const = 0;
    [[nodiscard]] virtual std::string constant(NodeId i) const = 0;
    /// Precedence of the node's expression: larger for products than for sums.
    [[nodiscard]] virtual int precedence(NodeId i) const = 0;

    [[nodiscard]] bool is_wide(NodeId i) const { return tape_.format_of(i) != form_format_; }
    [[nodiscard]] const std::string& name(NodeId i) const { return names_[i]; }

    const Tape& tape_;

private:
    void assign_names(const TapeCode* reference);
    /// Chooses the name of an operation and records it for later operations. `used` holds the names of all before it.
    std::string add_operation_name(const TapeNode& node, const TapeCode* reference, std::set<std::string>& used);
    /// Key of an operation: its name and the names of its operands.
    [[nodiscard]] std::string make_key(const TapeNode& node) const;
    /// Name of a difference of two inputs: `o_minus_centre_x` for `o.x - centre.x`; empty for other operations.
    [[nodiscard]] std::string input_difference_name(const TapeNode& node) const;
    [[nodiscard]] std::string identifier(std::string_view label) const;
    /// Counts the operations that use a result. A conversion counts as often as its own result is used.
    [[nodiscard]] int count_uses(NodeId i) const;
    [[nodiscard]] bool is_inlined(NodeId i) const { return is_inlined_[i]; }
    /// Decides which expressions are written inside others.
    void choose_inlined();

    std::vector<NodeId> outputs_;
    attribution::TapeSlice slice_;
    LanguageNames language_;
    FloatFormat form_format_;
    std::vector<std::string> input_names_;
    std::vector<std::string> names_;  ///< one per node
    /// Number of inputs that describe the primitive, between those of the ray and those of the matrix.
    std::size_t primitive_number_count_;
    /// Names of operations without a label, by their key (`make_key`). Equal operations have the same key.
    std::map<std::string, std::vector<std::string>> names_by_key_;
    /// One name per node: its own; for an operation without a label, the name of the first equal operation.
    std::vector<std::string> first_names_;
    int unnamed_count_ = 0;
    std::vector<bool> is_inlined_;  ///< one per node
};

}  // namespace lostbits::output::repair
