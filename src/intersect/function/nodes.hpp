// The operations of a function while they are recorded. Operations that do not round are simplified: decisions with a
// known result, selections between equal values, and numbers that are widened and then narrowed again.
#pragma once

#include <array>
#include <initializer_list>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "intersect/table/written_formula.hpp"

namespace lostbits::intersect::function {

/// Thrown for code that cannot be recorded. The text completes a message that begins with the place in the source.
struct NotFollowed : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A decision: the index of an operation, or `yes` or `no` for a known decision.
using Mask = NodeId;
inline constexpr Mask yes = -2, no = -3;

struct ProgramNode {
    TapeOp op = TapeOp::constant;
    bool wide = false;  ///< true if a function of float computes the number in double
    std::array<NodeId, 3> operands{no_node, no_node, no_node};
    double value = 0;  ///< value of a constant; may be NaN
    std::string label = {};
    int label_depth = 0;  ///< depth of calls at which the variable that gave the label is declared
    int place = -1;       ///< index of the source place; -1: none
};

class Nodes {
public:
    /// `bits` is the width of the format that the function takes and returns.
    explicit Nodes(int bits) : bits_(bits) {}

    int place = -1;  ///< index of the source place of the operations that are added next

    [[nodiscard]] const ProgramNode& operator[](NodeId i) const { return nodes_[i]; }
    [[nodiscard]] std::size_t size() const { return nodes_.size(); }
    [[nodiscard]] int bits() const { return bits_; }

    NodeId input(int index);
    NodeId constant(double value, bool wide);
    /// An arithmetic operation whose operands are all of the same format.
    NodeId arithmetic(TapeOp op, NodeId a, NodeId b = no_node, NodeId c = no_node);
    NodeId select(Mask when, NodeId a, NodeId b);
    NodeId widen(NodeId x);
    NodeId narrow(NodeId x);
    /// The smaller or the larger of two numbers, or the other operand if one is NaN: fmin and fmax of C, as x86
    /// computes them.
    NodeId minimum_or_maximum(TapeOp min_or_max, NodeId a, NodeId b);

    /// Directions of rounding to a whole number, in the order of floor, ceil, trunc, round, roundeven.
    enum class WholeNumber { below, above, towards_zero, nearest_or_away, nearest_or_even };
    NodeId round_to_whole(WholeNumber rounding, NodeId x);

    Mask compare(TapeOp op, NodeId a, NodeId b);
    Mask logical_and(Mask a, Mask b);
    Mask logical_or(Mask a, Mask b);
    Mask logical_not(Mask a);
    /// Selects `a` if `when` holds, and `b` otherwise.
    Mask select_mask(Mask when, Mask a, Mask b);
    Mask is_nan(NodeId x) { return logical_not(compare(TapeOp::less_equal, x, x)); }

    /// Names an operation. The name of a variable of an outer function takes precedence over one of an inner function.
    void name_node(NodeId i, const std::string& label, int depth);
    /// Returns the constants between which decisions select a number. Sets `has_others` if the number may also be a
    /// value that is not a constant.
    std::vector<double> constants_of(NodeId x, bool& has_others) const;

    struct FormulaWithPlaces {
        table::WrittenFormula formula;
        std::vector<int> places;           ///< index of the source place of each operation; -1: none
        std::vector<NodeId> operation_of;  ///< index of the operation of each node; `no_node` if no output depends on
                                           ///< the node
    };
    /// Returns the operations on which the outputs depend.
    [[nodiscard]] FormulaWithPlaces to_formula(Mask hit, NodeId t, NodeId near, NodeId far) const;

private:
    NodeId add(ProgramNode node);
    Mask logic(TapeOp op, Mask a, Mask b = no_node);
    /// Returns the number of the function's own format whose conversion is the double `x`; empty if `x` is not such a
    /// conversion.
    std::optional<NodeId> unwidened_node(NodeId x);
    std::optional<std::array<NodeId, 3>> unwidened_operands(const std::array<NodeId, 3>& operands, std::size_t count);
    [[nodiscard]] std::optional<double> exact_result(TapeOp op, double x, double y, bool wide) const;
    enum class Selection { left, right };
    std::optional<Mask> compare_side_by_side(TapeOp op, NodeId x, NodeId y, Selection selection);
    std::optional<std::pair<NodeId, NodeId>> narrow_comparison(TapeOp op, NodeId a, NodeId b);
    [[nodiscard]] std::vector<bool> find_needed(std::initializer_list<NodeId> outputs) const;
    [[nodiscard]] bool fits_format(double x) const;

    int bits_;
    std::vector<ProgramNode> nodes_;
    std::map<std::tuple<TapeOp, NodeId, NodeId, std::uint64_t, bool>, NodeId> known_nodes_;
};

}  // namespace lostbits::intersect::function
