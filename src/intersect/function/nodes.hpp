// The operations of a function while they are recorded. Parts that no rounding depends on are simplified: decisions
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

/// Something that cannot be followed. The text is the end of a sentence that begins with the place.
struct NotFollowed : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A decision: an operation, or one that is known.
using Mask = NodeId;
inline constexpr Mask yes = -2, no = -3;

struct ProgramNode {
    TapeOp op = TapeOp::constant;
    bool wide = false;  ///< computed in double by a function of float
    std::array<NodeId, 3> operands{no_node, no_node, no_node};
    double value = 0;  ///< value of a constant, which may be NaN
    std::string label = {};
    int label_depth = 0;  ///< number of calls around the variable that named it
    int place = -1;
};

class Nodes {
public:
    /// `bits`: of the format that the function takes and returns.
    explicit Nodes(int bits) : bits_(bits) {}

    int place = -1;  ///< place of the operations that follow

    [[nodiscard]] const ProgramNode& operator[](NodeId i) const { return all_[static_cast<std::size_t>(i)]; }
    [[nodiscard]] std::size_t size() const { return all_.size(); }
    [[nodiscard]] int bits() const { return bits_; }

    NodeId input(int number);
    NodeId constant(double value, bool wide);
    /// An arithmetic operation whose operands are all of the same format.
    NodeId number(TapeOp op, NodeId a, NodeId b = no_node, NodeId c = no_node);
    NodeId select(Mask when, NodeId a, NodeId b);
    NodeId widen(NodeId x);
    NodeId narrow(NodeId x);
    /// The smaller or the larger number, and the other one if one is NaN: C's fmin and fmax, as x86 computes them.
    NodeId least(TapeOp min_or_max, NodeId a, NodeId b);

    /// A whole number beside x: floor, ceil, trunc, round, roundeven.
    enum class WholeNumber { below, above, towards_zero, nearest_or_away, nearest_or_even };
    NodeId whole(WholeNumber which, NodeId x);

    Mask compare(TapeOp op, NodeId a, NodeId b);
    Mask both(Mask a, Mask b);
    Mask either(Mask a, Mask b);
    Mask opposite(Mask a);
    /// Selects `a` if `when` holds, and `b` otherwise.
    Mask choose(Mask when, Mask a, Mask b);
    Mask is_nan(NodeId x) { return opposite(compare(TapeOp::less_equal, x, x)); }

    /// Names an operation. A variable of an outer function replaces the name by one of an inner function.
    void name(NodeId i, const std::string& label, int depth);
    /// The constants that a number may be, each once; `others`: it may be something else, too.
    std::vector<double> constants_of(NodeId x, bool& others) const;

    struct Written {
        table::WrittenFormula formula;
        std::vector<int> places;           ///< place of each operation
        std::vector<NodeId> operation_of;  ///< operation of each node; none if no output depends on it
    };
    /// The operations that the outputs depend on.
    [[nodiscard]] Written written(Mask hit, NodeId t, NodeId near, NodeId far) const;

private:
    NodeId add(ProgramNode node);
    Mask logic(TapeOp op, Mask a, Mask b = no_node);
    /// The number in the function's own format that the double `x` is a conversion of; none if there is none.
    std::optional<NodeId> narrowed(NodeId x);
    [[nodiscard]] bool fits(double x) const;
    NodeId needed(Mask decision, Nodes& more) const;

    int bits_;
    std::vector<ProgramNode> all_;
    std::map<std::tuple<TapeOp, NodeId, NodeId, std::uint64_t, bool>, NodeId> known_;
};

}  // namespace lostbits::intersect::function
