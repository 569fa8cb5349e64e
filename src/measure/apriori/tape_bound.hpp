// Bounds the rounding error of a form's t for all inputs of a box at once.
//
// Let v be the value of a node of the tape without rounding and v^ the value that the format computes. For every
// operation
//
//   v^ − v = Σ q_k (v^_k − v_k) + e
//
// holds exactly, summed over its operands. The q_k are difference quotients between exact and computed operands: for a
// product ab, (b + b^)/2 and (a + a^)/2; for a/b, (1/b + 1/b^)/2 and −(a + a^)/(2 b b^); for a root, 1/(√a + √a^). e is
// the rounding error of the operation on its computed operands. So t^ − t = Σ A_i e_i, where A_i sums the products of
// the quotients on all paths from node i to t. The sum has no second-order remainder to bound: enclosures of all v and
// v^ over the box give enclosures of q, A and e, and of t^ − t. FPTaylor (Solovyev et al., TOPLAS 2018) sums up its
// first order. Daisy's (Darulova and Kuncak, POPL 2014) propagated errors have |q| in place of q.
#pragma once

#include <span>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "number/interval.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::apriori {

/// Range of one input: low ≤ x ≤ high.
struct InputRange {
    double low, high;
    [[nodiscard]] bool is_point() const { return low == high; }
};
/// Ranges of all inputs, in the order of a tape's inputs.
using InputBox = std::vector<InputRange>;

/// Bounds that hold for all inputs in a box that are numbers of the format.
struct BoxBound {
    bool misses = false;   ///< true if there is no hit, with rounding or without rounding
    bool decides = false;  ///< true if hit or miss is known, and the same with and without rounding
    /// Upper bound of |t^ − t| wherever both hit, in units of t; infinite if unknown.
    double error = HUGE_VAL;
    double min_t = 0;  ///< lower bound of |t|
};

/// Bounds the error of a form that performs the same operations for every ray (`tape::record_tape`), over any number of
/// boxes.
class TapeBound {
public:
    explicit TapeBound(const Tape& tape);

    [[nodiscard]] BoxBound bound_over(const InputBox& box) const;
    /// Contribution of each node by itself: an upper bound of |A_i e_i|. The sum of the contributions is at least the
    /// bound, because the bound accounts for rounding errors that are the same for every input and cancel.
    [[nodiscard]] std::vector<double> node_contributions(const InputBox& box) const;

private:
    const Tape& tape_;
    std::vector<bool> needed_;  ///< nodes that t or the decision depends on
};

/// A box. If it has been halved, it is split at `middle` of the input with index `axis`; the middle belongs to both
/// halves.
struct SubBox {
    InputBox box = {};
    BoxBound bound = {};
    double volume_fraction = 1;  ///< fraction of the volume of the whole box
    int stale_halvings = 0;      ///< number of successive halvings that did not make the bound smaller by 2 %
    int axis = -1;
    double middle = 0;
    std::size_t lower_half = 0;  ///< index of the lower half; the upper half follows it

    [[nodiscard]] bool is_halved() const { return axis >= 0; }
};

class BoxSubdivision {
public:
    /// Divides `whole` into at most `max_leaves` boxes, the same ones for any number of threads.
    BoxSubdivision(const TapeBound& bound, InputBox whole, std::size_t max_leaves,
                   const intersect::process::StopToken& stop);

    /// The box that contains these inputs, which lie in the whole box.
    [[nodiscard]] const SubBox& part_of(std::span<const double> inputs) const;
    /// The boxes that are not halved.
    [[nodiscard]] std::vector<const SubBox*> leaves() const;

private:
    [[nodiscard]] std::vector<std::size_t> choose_boxes_to_halve(std::size_t limit) const;
    void halve(std::span<const std::size_t> parts_to_halve, const TapeBound& bound,
               const intersect::process::StopToken& stop);

    std::vector<SubBox> parts_;
    int variable_count_ = 0;  ///< number of inputs whose range is not a single number
};

}  // namespace lostbits::measure::apriori
