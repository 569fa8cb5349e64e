#include "measure/apriori/tape_bound.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "intersect/process/parallel.hpp"
#include "measure/apriori/enclosed_node.hpp"

namespace lostbits::measure::apriori {

namespace {

/// 128 bits hold the product of two doubles, which has 106, so rounding hardly widens an enclosure; the box does.
constexpr long interval_bits = 128;

/// Intersection of a and b.
Interval intersection(const Interval& a, const Interval& b) {
    return enclose_between(mpfr_greater_p(a.lower(), b.lower()) != 0 ? a : b,
                           mpfr_less_p(a.upper(), b.upper()) != 0 ? a : b);
}

/// Enclosures of all nodes over a box. Intervals alone are wide for a formula in which an input occurs often. So every
/// node also has its value m at the middle of the box and slopes s_k, with v = m + Σ s_k (x_k − middle of x_k) without
/// rounding. The slopes are products of difference quotients (tape_bound.hpp), as the errors are. For the slopes the
/// quotients compare v with m, in place of v^ with v. `error_` holds the whole rounding error of each node.
class EnclosedTape {
public:
    EnclosedTape(const Tape& tape, const std::vector<bool>& needed, const InputBox& box)
        : tape_(tape),
          box_(box),
          nodes_(tape.nodes.size()),
          unrounded_(nodes_),
          middle_(nodes_),
          slopes_(nodes_.size()),
          error_(nodes_.size()) {
        for (std::size_t k = 0; k < box.size(); ++k)
            if (!box[k].is_point()) variable_inputs_.push_back(k);
        for (NodeId i = 0; i < tape.size(); ++i)
            if (needed[i]) enclose_node(i);
    }

    [[nodiscard]] const std::vector<EnclosedNode>& nodes() const { return nodes_; }

private:
    [[nodiscard]] EnclosedNode enclose_with(NodeId i, const std::vector<EnclosedNode>& operand_nodes) const {
        NodeContext context{tape_[i], {}, tape_.format_of(i), tape_.format_of(i)};
        const auto operands = tape_.operands_of(i);
        for (std::size_t k = 0; k < operands.size(); ++k) context.operands[k] = &operand_nodes[operands[k]];
        if (tape_[i].op == TapeOp::convert) context.operand_format = tape_.format_of(operands[0]);
        return enclose(context);
    }

    void enclose_node(NodeId i) {
        if (tape_[i].op == TapeOp::input) return enclose_input_node(i);
        EnclosedNode& node = nodes_[i] = enclose_with(i, nodes_);
        unrounded_[i] = enclose_with(i, unrounded_);
        middle_[i] = enclose_with(i, middle_);
        drop_rounding(middle_[i]);
        if (node.is_known && !is_decision(tape_[i].op)) narrow_node(i, node);
        unrounded_[i].is_known = node.is_known;
        unrounded_[i].exact = node.exact;
        unrounded_[i].exact_decision = node.exact_decision;
        drop_rounding(unrounded_[i]);
    }

    void enclose_input_node(NodeId i) {
        const std::size_t k = tape_[i].operands[0];
        const double middle = box_.at(k).is_point() ? box_[k].low : box_[k].low / 2 + box_[k].high / 2;
        nodes_[i] = unrounded_[i] = enclose_input(box_[k].low, box_[k].high);
        middle_[i] = enclose_input(middle, middle);
        for (const std::size_t f : variable_inputs_) slopes_[i].emplace_back(f == k ? 1 : 0);
    }

    static void drop_rounding(EnclosedNode& node) {
        node.computed = node.exact;
        node.computed_decision = node.exact_decision;
    }

    void narrow_node(NodeId i, EnclosedNode& node) {
        if (is_given(tape_[i].op)) {
            slopes_[i].assign(variable_inputs_.size(), Interval(0));
            error_[i] = node.rounding;
            return;
        }

        // The error: the node's own rounding, and the errors of its operands by their quotients.
        const auto operands = tape_.operands_of(i);
        Interval error = node.rounding;
        for (std::size_t k = 0; k < operands.size(); ++k)
            if (!is_decision(tape_[operands[k]].op)) error = error + node.quotients[k] * error_[operands[k]];
        error_[i] = error;

        // The range, by the mean value theorem: the value in the middle, and the slopes times the distances from there.
        set_slopes(i);
        if (!slopes_[i].empty() || variable_inputs_.empty()) {
            Interval range = middle_[i].exact;
            for (std::size_t f = 0; f < variable_inputs_.size(); ++f) {
                const Interval x = Interval::between(box_[variable_inputs_[f]].low, box_[variable_inputs_[f]].high);
                range =
                    range + slopes_[i][f] *
                                (x - Interval(box_[variable_inputs_[f]].low / 2 + box_[variable_inputs_[f]].high / 2));
            }
            if (range.is_bounded()) node.exact = intersection(node.exact, range);
        }

        if (error.is_bounded()) node.computed = intersection(node.computed, node.exact + error);
    }

    /// Leaves the slopes empty if the node may jump, or if the middle or an operand with a nonzero quotient is unknown.
    void set_slopes(NodeId i) {
        const EnclosedNode& exact_node = unrounded_[i];
        if (!exact_node.is_known || !middle_[i].is_known || exact_node.may_jump) return;
        const auto operands = tape_.operands_of(i);
        std::vector<Interval> sum(variable_inputs_.size(), Interval(0));
        for (std::size_t k = 0; k < operands.size(); ++k) {
            const NodeId operand = operands[k];
            if (is_decision(tape_[operand].op) || is_zero(exact_node.quotients[k])) continue;
            if (slopes_[operand].size() != variable_inputs_.size()) return;
            for (std::size_t f = 0; f < variable_inputs_.size(); ++f)
                sum[f] = sum[f] + exact_node.quotients[k] * slopes_[operand][f];
        }
        slopes_[i] = std::move(sum);
    }

    const Tape& tape_;
    const InputBox& box_;
    std::vector<std::size_t> variable_inputs_;  ///< inputs whose range is not a single number

    std::vector<EnclosedNode> nodes_;
    std::vector<EnclosedNode> unrounded_, middle_;  ///< without rounding, over the box and at its middle
    std::vector<std::vector<Interval>> slopes_;
    std::vector<Interval> error_;
};

/// Slope of t with respect to each node (A_i in tape_bound.hpp). Returns nothing if t depends on a node that is
/// unknown.
std::optional<std::vector<Interval>> slopes_of_t(const Tape& tape, const std::vector<EnclosedNode>& nodes) {
    std::vector<Interval> slope(nodes.size());
    slope[tape.outputs.t] = Interval(1);
    for (NodeId i = tape.outputs.t; i >= 0; --i) {
        if (is_decision(tape[i].op) || is_zero(slope[i])) continue;
        if (!nodes[i].is_known || !slope[i].is_bounded()) return {};
        if (is_given(tape[i].op)) continue;
        const auto operands = tape.operands_of(i);
        for (std::size_t k = 0; k < operands.size(); ++k) {
            if (is_decision(tape[operands[k]].op) || is_zero(nodes[i].quotients[k])) continue;
            Interval& sum = slope[operands[k]];
            sum = sum + slope[i] * nodes[i].quotients[k];
        }
    }
    return slope;
}

std::vector<bool> nodes_of_answer(const Tape& tape) {
    std::vector<bool> needed(tape.nodes.size());
    for (const NodeId out : {tape.outputs.hit, tape.outputs.t}) needed.at(out) = true;
    for (NodeId i = tape.size() - 1; i >= 0; --i) {
        if (!needed[i] || is_given(tape[i].op)) continue;
        for (const NodeId operand : tape.operands_of(i)) needed[operand] = true;
    }
    return needed;
}

/// Returns the index of the input whose range is widest relative to its whole range; −1 if no range can be halved.
int axis_to_halve(const InputBox& box, const InputBox& whole) {
    int axis = -1;
    double largest_width = 0;
    for (std::size_t k = 0; k < box.size(); ++k) {
        const double middle = box[k].low / 2 + box[k].high / 2;
        const double width = (box[k].high - box[k].low) / (whole[k].high - whole[k].low);
        if (!(box[k].low < middle && middle < box[k].high) || !(width > largest_width)) continue;
        largest_width = width;
        axis = static_cast<int>(k);
    }
    return axis;
}

/// Excess in bits of a box whose bound is unknown. Larger than the excess of any known bound.
constexpr double unknown_excess_bits = 64;
/// A halving is stale if the bound of a half is larger than this fraction of the bound before.
constexpr double stale_fraction = 0.98;
/// One in this many leaves is halved in each round, rounded up.
constexpr std::size_t leaves_per_halving = 4;

}  // namespace

TapeBound::TapeBound(const Tape& tape) : tape_(tape), needed_(nodes_of_answer(tape)) {}

BoxBound TapeBound::bound_over(const InputBox& box) const {
    const Interval::Precision precision(interval_bits);
    const EnclosedTape enclosed(tape_, needed_, box);
    const auto& nodes = enclosed.nodes();
    const EnclosedNode& hit = nodes[tape_.outputs.hit];
    BoxBound bound;
    bound.misses = hit.exact_decision.is_no() || hit.computed_decision.is_no();
    bound.decides = !hit.exact_decision.is_unknown() && hit.exact_decision == hit.computed_decision;
    const EnclosedNode& t = nodes[tape_.outputs.t];
    if (bound.misses || !t.is_known) return bound;
    bound.min_t = lower_magnitude(t.exact);
    const auto slope = slopes_of_t(tape_, nodes);
    if (!slope) return bound;
    Interval error(0);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (!is_zero((*slope)[i])) error = error + (*slope)[i] * nodes[i].rounding;
    if (error.is_bounded()) bound.error = std::fmin(upper_magnitude(error), upper_magnitude(t.computed - t.exact));
    return bound;
}

std::vector<double> TapeBound::node_contributions(const InputBox& box) const {
    const Interval::Precision precision(interval_bits);
    const EnclosedTape enclosed(tape_, needed_, box);
    const auto& nodes = enclosed.nodes();
    std::vector<double> contributions(nodes.size());
    const auto slope = slopes_of_t(tape_, nodes);
    for (std::size_t i = 0; slope && i < nodes.size(); ++i)
        contributions[i] = upper_magnitude((*slope)[i] * nodes[i].rounding);
    return contributions;
}

BoxSubdivision::BoxSubdivision(const TapeBound& bound, InputBox whole, std::size_t max_leaves,
                               const intersect::process::StopToken& stop) {
    variable_count_ = static_cast<int>(std::ranges::count_if(whole, [](const InputRange& x) { return !x.is_point(); }));
    parts_.push_back({.bound = bound.bound_over(whole)});
    parts_.front().box = std::move(whole);
    for (std::size_t leaves = 1; leaves < max_leaves;) {
        const auto chosen = choose_boxes_to_halve(
            std::min((leaves + leaves_per_halving - 1) / leaves_per_halving, max_leaves - leaves));
        if (chosen.empty()) break;
        halve(chosen, bound, stop);
        leaves += chosen.size();
    }
}

/// Returns the boxes with the largest scores. The score of a box is its volume times the bits by which its bound
/// exceeds the smallest bound of all boxes.
std::vector<std::size_t> BoxSubdivision::choose_boxes_to_halve(std::size_t limit) const {
    double smallest_error = HUGE_VAL;
    for (const SubBox& box : parts_)
        if (!box.is_halved() && box.bound.error > 0) smallest_error = std::fmin(smallest_error, box.bound.error);
    std::vector<std::pair<double, std::size_t>> candidates;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const SubBox& p = parts_[i];
        if (p.is_halved() || p.bound.misses || p.bound.error == 0 || p.stale_halvings >= 2 * variable_count_) continue;
        if (axis_to_halve(p.box, parts_.front().box) < 0) continue;
        const double excess_bits =
            p.bound.error < HUGE_VAL ? 1 + std::log2(p.bound.error / smallest_error) : unknown_excess_bits;
        candidates.emplace_back(p.volume_fraction * excess_bits, i);
    }
    std::ranges::sort(candidates, [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    candidates.resize(std::min(limit, candidates.size()));
    std::vector<std::size_t> chosen;
    for (const auto& [score, i] : candidates) chosen.push_back(i);
    return chosen;
}

void BoxSubdivision::halve(std::span<const std::size_t> parts_to_halve, const TapeBound& bound,
                           const intersect::process::StopToken& stop) {
    const std::size_t first = parts_.size();
    for (const std::size_t i : parts_to_halve) {
        SubBox& p = parts_[i];
        p.axis = axis_to_halve(p.box, parts_.front().box);
        InputRange& range = p.box[p.axis];
        p.middle = range.low / 2 + range.high / 2;

        p.lower_half = parts_.size();
        SubBox lower = p, upper = p;
        lower.axis = upper.axis = -1;
        lower.volume_fraction = upper.volume_fraction = p.volume_fraction / 2;
        lower.box[p.axis].high = p.middle;
        upper.box[p.axis].low = p.middle;
        parts_.push_back(std::move(lower));
        parts_.push_back(std::move(upper));
    }

    // A half never gets a larger bound than the whole.
    intersect::process::in_parallel(first, parts_.size(), [&](std::size_t i) {
        stop.check();
        SubBox& p = parts_[i];
        const double previous_error = p.bound.error;
        p.bound = bound.bound_over(p.box);
        p.bound.error = std::fmin(p.bound.error, previous_error);
        p.stale_halvings = p.bound.error > stale_fraction * previous_error ? p.stale_halvings + 1 : 0;
    });
}

const SubBox& BoxSubdivision::part_of(std::span<const double> inputs) const {
    const SubBox* p = &parts_.front();
    while (p->is_halved()) p = &parts_[p->lower_half + (inputs[p->axis] > p->middle ? 1 : 0)];
    return *p;
}

std::vector<const SubBox*> BoxSubdivision::leaves() const {
    std::vector<const SubBox*> result;
    for (const SubBox& box : parts_)
        if (!box.is_halved()) result.push_back(&box);
    return result;
}

}  // namespace lostbits::measure::apriori
