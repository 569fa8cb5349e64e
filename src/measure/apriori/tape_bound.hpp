// How far rounding can put the t of a form, for all inputs of a box at once.
//
// Let v be what a node of the tape is without rounding and v^ what the format makes of it. For every operation
//     v^ − v = Σ q_k (v^_k − v_k) + e
// over its operands, exactly, where q_k are difference quotients between exact and computed operands (of a product
// ab: (b + b^)/2 and (a + a^)/2; of a/b: (1/b + 1/b^)/2 and −(a + a^)/(2 b b^); of a root: 1/(√a + √a^)) and e is what
// the operation rounds on its computed operands. So t^ − t = Σ A_i e_i, A_i the sum of the products of the quotients on
// all ways from node i to t. Nothing is left over, so there is no second order to bound: enclosures of all v and v^
// over the box give enclosures of q, A and e, and of t^ − t. The first order of it is what FPTaylor (Solovyev et al.,
// TOPLAS 2018) sums up, and Daisy's (Darulova and Kuncak, POPL 2014) propagated errors are |q| in the place of q.
#pragma once

#include <span>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "number/interval.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::apriori {

/// Of one number of the inputs: low ≤ x ≤ high.
struct Between {
    double low, high;
    [[nodiscard]] bool is_point() const { return low == high; }
};
/// Of every number, in the order of a tape's inputs.
using InputBox = std::vector<Between>;

/// What is certain of every number of the format in a box.
struct BoxBound {
    bool misses = false;   ///< with or without rounding there is no hit
    bool decides = false;  ///< hit or miss is the same with and without rounding
    /// At least |t^ − t|, t without rounding, wherever both hit, in units of t; infinity where nothing is known.
    double error = HUGE_VAL;
    double least = 0;  ///< no |t| is below it
};

/// The tape of a form that does the same operations to every ray (`tape::tape_of`), over one box after the other.
class TapeBound {
public:
    explicit TapeBound(const Tape& tape);

    [[nodiscard]] BoxBound over(const InputBox& box) const;
    /// What of the bound each node makes by itself: at least |A_i e_i|. They add up to at least the bound, which knows
    /// where rounding errors that are the same for every input undo each other.
    [[nodiscard]] std::vector<double> shares(const InputBox& box) const;

private:
    const Tape& tape_;
    std::vector<bool> needed_;  ///< for t or the decision
};

/// A box, and its halves where it has been halved: at `middle` of number `axis`, which belongs to both.
struct BoundedPart {
    InputBox box = {};
    BoxBound bound = {};
    double share = 1;  ///< of the volume of the whole
    int stale = 0;     ///< so often in a row halving has not made the bound smaller by 2 %
    int axis = -1;
    double middle = 0;
    std::size_t below = 0;  ///< its place, before that of the other half

    [[nodiscard]] bool is_halved() const { return axis >= 0; }
};

class Subdivided {
public:
    /// In at most so many boxes, the same for any number of threads.
    Subdivided(const TapeBound& bound, InputBox whole, std::size_t boxes, const intersect::process::StopToken& stop);

    /// The box that holds these inputs, which are of the whole.
    [[nodiscard]] const BoundedPart& part_of(std::span<const double> inputs) const;
    /// The boxes that are not halved.
    [[nodiscard]] std::vector<const BoundedPart*> leaves() const;

private:
    [[nodiscard]] std::vector<std::size_t> worth_halving(std::size_t at_most) const;
    void halve(std::span<const std::size_t> which, const TapeBound& bound, const intersect::process::StopToken& stop);

    std::vector<BoundedPart> parts_;
    int free_ = 0;  ///< inputs that are not one number
};

}  // namespace lostbits::measure::apriori
