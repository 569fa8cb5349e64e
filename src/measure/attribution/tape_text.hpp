// Writes a tape as readable expressions.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::attribution {

/// Names and expressions of the operations of one tape. A node has the name that the formula gives it. If a name
/// occurs again, as in a loop over axes, it is numbered: `tmin`, `tmin2`. Sums of three products are written as dot
/// products, and the three components of a vector in one as `v1.x`, `v1.y`, `v1.z`. Any other expression is written out
/// if it is short; otherwise it gets a name such as `s12`.
class TapeText {
public:
    /// `plain` is ASCII: `dot(a, b) - r*r`. `pretty`: `a·b − r·r`. `generic`: as plain, but the same for every
    /// axis and every round of a loop.
    enum class TextStyle { plain, pretty, generic };

    TapeText(const Tape& tape, std::vector<std::string> inputs, TextStyle style);

    /// Unique on the tape: `c`, `v1.x`, `s12`, an input's name, a constant's digits.
    [[nodiscard]] const std::string& name(NodeId i) const { return names_[i]; }
    /// The name as a C identifier; for a constant, its digits.
    [[nodiscard]] std::string identifier(NodeId i) const;
    /// The right-hand side of the definition of node i: `dot(o - centre, o - centre) - radius*radius`.
    [[nodiscard]] const std::string& expression(NodeId i) const;
    /// Text of the node within a larger expression: the name that the formula gives it, otherwise its expression.
    [[nodiscard]] std::string operand(NodeId i) const { return operand(i, 0); }
    /// `c = dot(…) - radius*radius`, or only the expression if the formula does not name it.
    [[nodiscard]] std::string definition(NodeId i) const;
    /// Category of an operation in a map, in the generic style: `inv = 1/d.i`. Several operations may have the same
    /// category.
    [[nodiscard]] std::string category(NodeId i) const;
    /// True for an operation that only builds a number of a user's file, such as 1e-6, from integers: the pretty style
    /// writes the number.
    [[nodiscard]] bool is_number(NodeId i) const { return !number_texts_[i].empty(); }

private:
    using Triple = std::array<NodeId, 3>;
    struct Dot {
        Triple a, b;
    };
    [[nodiscard]] bool is_vector(const Triple& v) const;
    /// True if node i is the last sum of a dot product; sets `dot` to its vectors.
    [[nodiscard]] bool find_dot(NodeId i, Dot& dot) const;
    void name_vector(const Triple& v);
    void name_all_nodes();
    void find_numbers();
    [[nodiscard]] bool is_simple(NodeId i) const;
    [[nodiscard]] std::string vector_text(const Triple& v, bool without_brackets) const;
    [[nodiscard]] std::string operand(NodeId i, int precedence) const;
    [[nodiscard]] std::string compose(NodeId i) const;
    [[nodiscard]] std::string write_out(NodeId i) const;

    const Tape& tape_;
    std::vector<std::string> inputs_;
    TextStyle style_;
    std::vector<std::string> names_;
    std::vector<std::string> number_texts_;  ///< digits of each operation that builds a number; empty for all others
    std::map<Triple, std::string> vectors_;
    mutable std::vector<std::string> expressions_;  ///< filled on demand: in a march, each step recurs in the next
    std::vector<NodeId> dot_of_part_;  ///< for each partial sum or product of a dot product, the node of its last sum
};

}  // namespace lostbits::measure::attribution
