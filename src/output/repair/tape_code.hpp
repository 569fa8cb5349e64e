// A tape as statements of any language: operations with statements of their own, and their names.
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

/// Names of the numbers of the primitive in a language, and words that cannot be names there.
struct LanguageNames {
    std::string primitive;  ///< prefix of `centre.x`
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
    /// Node i as an operand, in parentheses if it binds less tightly.
    [[nodiscard]] std::string operand(NodeId i, int binds) const;

protected:
    /// Code for whatever `wanted` is computed from. `like`: operations without a name of their own have the names that
    /// they have there.
    TapeCode(const Tape& tape, const Intersector& form, std::vector<NodeId> wanted, LanguageNames language,
             const TapeCode* like = nullptr);

    [[nodiscard]] virtual std::string statement(NodeId i) const = 0;
    [[nodiscard]] virtual std::string expression(NodeId i) const = 0;
    [[nodiscard]] virtual std::string constant(NodeId i) const = 0;
    /// Precedence of the node's expression.
    [[nodiscard]] virtual int binding(NodeId i) const = 0;

    [[nodiscard]] bool is_wide(NodeId i) const { return tape_.format_of(i) != own_; }
    [[nodiscard]] const std::string& name(NodeId i) const { return names_[static_cast<std::size_t>(i)]; }

    const Tape& tape_;

private:
    void name_all(const TapeCode* like);
    std::string new_name(const TapeNode& n, const TapeCode* like, std::set<std::string>& used);
    /// The operation and the names of its operands, as a key.
    [[nodiscard]] std::string text_of(const TapeNode& n) const;
    /// `o_minus_centre_x` for `o.x - centre.x`.
    [[nodiscard]] std::string of_inputs(const TapeNode& n) const;
    [[nodiscard]] std::string identifier(std::string_view label) const;
    /// Number of operations that use a result. A conversion counts as the uses of what it converts.
    [[nodiscard]] int uses(NodeId i) const;
    [[nodiscard]] bool is_inlined(NodeId i) const { return inlined_[static_cast<std::size_t>(i)]; }
    void choose_inlined();

    std::vector<NodeId> wanted_;
    attribution::TapeSlice slice_;
    LanguageNames language_;
    FloatFormat own_;
    std::vector<std::string> inputs_, names_;
    std::size_t primitive_numbers_;  ///< inputs after the ray; the matrix follows
    /// Names of operations without a label, by their key; the first is that of equal operations.
    std::map<std::string, std::vector<std::string>> known_;
    std::vector<std::string> first_names_;
    int unnamed_ = 0;
    std::vector<bool> inlined_;
};

}  // namespace lostbits::output::repair
