// The operations of a function while they are recorded. Parts on which no rounding depends are simplified: decisions
// with a known result, choices between equal sides, numbers that are widened and narrowed again.
#pragma once

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "intersect/table/written_formula.hpp"

namespace lostbits::intersect::function {

/// Thrown for something that cannot be followed. The text is the end of a sentence that begins with the place.
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
    int label_depth = 0;  ///< depth of calls at the variable that gave the label
    int place = -1;
};

class Nodes {
public:
    /// `bits` is the width of the format that the function takes and returns.
    explicit Nodes(int bits) : bits_(bits) {}

    int place = -1;  ///< index of the source place of the operations that are added next

    [[nodiscard]] const ProgramNode& operator[](NodeId i) const { return all_[static_cast<std::size_t>(i)]; }
    [[nodiscard]] std::size_t size() const { return all_.size(); }
    [[nodiscard]] int bits() const { return bits_; }

    NodeId input(int index);
    NodeId constant(double value, bool wide);
    /// An arithmetic operation whose operands are all of the same format.
    NodeId number(TapeOp op, NodeId a, NodeId b = no_node, NodeId c = no_node);
    NodeId select(Mask when, NodeId a, NodeId b);
    NodeId widen(NodeId x);
    NodeId narrow(NodeId x);
    /// The smaller or the larger of two numbers; the other operand if one is NaN. C's fmin and fmax, as x86 computes
    /// them.
    NodeId least(TapeOp min_or_max, NodeId a, NodeId b);

    /// How to round to a whole number: floor, ceil, trunc, round, roundeven.
    enum class WholeNumber { below, above, towards_zero, nearest_or_away, nearest_or_even };
    NodeId whole(WholeNumber rounding, NodeId x);

    Mask compare(TapeOp op, NodeId a, NodeId b);
    Mask both(Mask a, Mask b);
    Mask either(Mask a, Mask b);
    Mask opposite(Mask a);
    /// Selects `a` if `when` holds, and `b` otherwise.
    Mask choose(Mask when, Mask a, Mask b);
    Mask is_nan(NodeId x) { return opposite(compare(TapeOp::less_equal, x, x)); }

    /// Names an operation. A variable of an outer function replaces the name by one of an inner function.
    void name(NodeId i, const std::string& label, int depth);
    /// The constants that a number may be, without repetition. Sets `has_others` if the number may be something else,
    /// too.
    std::vector<double> constants_of(NodeId x, bool& has_others) const;

    struct Written {
        table::WrittenFormula formula;
        std::vector<int> places;           ///< index of the source place of each operation; -1: none
        std::vector<NodeId> operation_of;  ///< index of the operation of each node; `no_node` if no output depends on
                                           ///< the node
    };
    /// Returns the operations on which the outputs depend.
    [[nodiscard]] Written written(Mask hit, NodeId t, NodeId near, NodeId far) const;

private:
    NodeId add(ProgramNode node);
    Mask logic(TapeOp op, Mask a, Mask b = no_node);
    /// The number in the function's own format of which the double `x` is a conversion. Empty if there is no such
    /// number.
    std::optional<NodeId> unconverted(NodeId x);
    [[nodiscard]] bool fits(double x) const;

    int bits_;
    std::vector<ProgramNode> all_;
    std::map<std::tuple<TapeOp, NodeId, NodeId, std::uint64_t, bool>, NodeId> known_;
};

}  // namespace lostbits::intersect::function
