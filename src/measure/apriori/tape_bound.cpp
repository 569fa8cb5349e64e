#include "measure/apriori/tape_bound.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "intersect/process/parallel.hpp"
#include "measure/apriori/enclosed_node.hpp"

namespace lostbits::measure::apriori {

namespace {

/// 128 bits: the product of two doubles has 106. The width of an enclosure then comes from the box, not from the
/// precision.
constexpr long bits = 128;

/// Intersection of a and b.
Interval common(const Interval& a, const Interval& b) {
    return between(mpfr_greater_p(a.lower(), b.lower()) != 0 ? a : b, mpfr_less_p(a.upper(), b.upper()) != 0 ? a : b);
}

/// Enclosures of all nodes over a box. Intervals alone are wide for a formula in which an input occurs often. So every
/// node also has its value m at the middle of the box and slopes s_k, with v = m + Σ s_k (x_k − middle of x_k) without
/// rounding. The slopes come from the same quotients as errors do, taken between v and m. Δ is the whole rounding error
/// of the node.
class EnclosedTape {
public:
    EnclosedTape(const Tape& tape, const std::vector<bool>& needed, const InputBox& box)
        : tape_(tape),
          box_(box),
          all_(tape.nodes.size()),
          exact_(all_),
          middle_(all_),
          slopes_(all_.size()),
          error_(all_.size()) {
        for (std::size_t k = 0; k < box.size(); ++k)
            if (!box[k].is_point()) free_.push_back(k);
        for (NodeId i = 0; i < tape.size(); ++i)
            if (needed[place(i)]) put(i);
    }

    [[nodiscard]] const std::vector<EnclosedNode>& nodes() const { return all_; }

private:
    static std::size_t place(NodeId i) { return static_cast<std::size_t>(i); }

    [[nodiscard]] EnclosedNode made(NodeId i, const std::vector<EnclosedNode>& from) const {
        NodeContext context{tape_[i], {}, tape_.format_of(i), tape_.format_of(i)};
        const auto operands = tape_.operands_of(i);
        for (std::size_t k = 0; k < operands.size(); ++k) context.operands[k] = &from[place(operands[k])];
        if (tape_[i].op == TapeOp::convert) context.from = tape_.format_of(operands[0]);
        return enclose(context);
    }

    void put(NodeId i) {
        if (tape_[i].op == TapeOp::input) return put_input(i);
        EnclosedNode& node = all_[place(i)] = made(i, all_);
        exact_[place(i)] = made(i, exact_);
        middle_[place(i)] = made(i, middle_);
        put_as_exact(middle_[place(i)]);
        if (node.known && !is_decision(tape_[i].op)) narrow(i, node);
        exact_[place(i)].known = node.known;
        exact_[place(i)].exact = node.exact;
        exact_[place(i)].exact_decision = node.exact_decision;
        put_as_exact(exact_[place(i)]);
    }

    void put_input(NodeId i) {
        const auto k = place(tape_[i].operands[0]);
        const double middle = box_.at(k).is_point() ? box_[k].low : box_[k].low / 2 + box_[k].high / 2;
        all_[place(i)] = exact_[place(i)] = enclose_input(box_[k].low, box_[k].high);
        middle_[place(i)] = enclose_input(middle, middle);
        for (const std::size_t f : free_) slopes_[place(i)].emplace_back(f == k ? 1 : 0);
    }

    static void put_as_exact(EnclosedNode& node) {
        node.computed = node.exact;
        node.computed_decision = node.exact_decision;
    }

    void narrow(NodeId i, EnclosedNode& node) {
        if (is_given(tape_[i].op)) {
            slopes_[place(i)].assign(free_.size(), Interval(0));
            error_[place(i)] = node.rounding;
            return;
        }
        const auto operands = tape_.operands_of(i);
        Interval off = node.rounding;
        for (std::size_t k = 0; k < operands.size(); ++k)
            if (!is_decision(tape_[operands[k]].op)) off = off + node.quotients[k] * error_[place(operands[k])];
        error_[place(i)] = off;
        put_slopes(i);
        if (!slopes_[place(i)].empty() || free_.empty()) {
            Interval range = middle_[place(i)].exact;
            for (std::size_t f = 0; f < free_.size(); ++f) {
                const Interval x = Interval::between(box_[free_[f]].low, box_[free_[f]].high);
                range = range + slopes_[place(i)][f] * (x - Interval(box_[free_[f]].low / 2 + box_[free_[f]].high / 2));
            }
            if (range.is_bounded()) node.exact = common(node.exact, range);
        }
        if (off.is_bounded()) node.computed = common(node.computed, node.exact + off);
    }

    /// Leaves the slopes empty if the node jumps, or if the middle or an operand that matters is unknown.
    void put_slopes(NodeId i) {
        const EnclosedNode& quotients = exact_[place(i)];
        if (!quotients.known || !middle_[place(i)].known || quotients.jumps) return;
        const auto operands = tape_.operands_of(i);
        std::vector<Interval> sum(free_.size(), Interval(0));
        for (std::size_t k = 0; k < operands.size(); ++k) {
            const auto operand = place(operands[k]);
            if (is_decision(tape_[operands[k]].op) || is_zero(quotients.quotients[k])) continue;
            if (slopes_[operand].size() != free_.size()) return;
            for (std::size_t f = 0; f < free_.size(); ++f)
                sum[f] = sum[f] + quotients.quotients[k] * slopes_[operand][f];
        }
        slopes_[place(i)] = std::move(sum);
    }

    const Tape& tape_;
    const InputBox& box_;
    std::vector<std::size_t> free_;  ///< inputs whose range is not a single number

    std::vector<EnclosedNode> all_, exact_, middle_;  ///< `exact_` and `middle_`: without rounding, over the box and at
                                                      ///< its middle
    std::vector<std::vector<Interval>> slopes_;
    std::vector<Interval> error_;
};

/// A_i of every node that t depends on; nothing if t depends on a node that is unknown.
std::optional<std::vector<Interval>> slopes(const Tape& tape, const std::vector<EnclosedNode>& all) {
    std::vector<Interval> slope(all.size());
    slope[static_cast<std::size_t>(tape.outputs.t)] = Interval(1);
    for (NodeId i = tape.outputs.t; i >= 0; --i) {
        const auto at = static_cast<std::size_t>(i);
        if (is_decision(tape[i].op) || is_zero(slope[at])) continue;
        if (!all[at].known || !slope[at].is_bounded()) return {};
        if (is_given(tape[i].op)) continue;
        const auto operands = tape.operands_of(i);
        for (std::size_t k = 0; k < operands.size(); ++k) {
            if (is_decision(tape[operands[k]].op) || is_zero(all[at].quotients[k])) continue;
            Interval& sum = slope[static_cast<std::size_t>(operands[k])];
            sum = sum + slope[at] * all[at].quotients[k];
        }
    }
    return slope;
}

std::vector<bool> nodes_of_answer(const Tape& tape) {
    std::vector<bool> needed(tape.nodes.size());
    for (const NodeId out : {tape.outputs.hit, tape.outputs.t}) needed.at(static_cast<std::size_t>(out)) = true;
    for (NodeId i = tape.size() - 1; i >= 0; --i) {
        if (!needed[static_cast<std::size_t>(i)] || is_given(tape[i].op)) continue;
        for (const NodeId operand : tape.operands_of(i)) needed[static_cast<std::size_t>(operand)] = true;
    }
    return needed;
}

/// The number whose range is widest relative to its whole range; −1 if no range can be halved.
int widest(const InputBox& box, const InputBox& whole) {
    int found = -1;
    double most = 0;
    for (std::size_t k = 0; k < box.size(); ++k) {
        const double middle = box[k].low / 2 + box[k].high / 2;
        const double width = (box[k].high - box[k].low) / (whole[k].high - whole[k].low);
        if (!(box[k].low < middle && middle < box[k].high) || !(width > most)) continue;
        most = width;
        found = static_cast<int>(k);
    }
    return found;
}

/// Score in bits of a box whose bound is unknown. No known bound is too wide by so much.
constexpr double unknown_bits = 64;

}  // namespace

TapeBound::TapeBound(const Tape& tape) : tape_(tape), needed_(nodes_of_answer(tape)) {}

BoxBound TapeBound::over(const InputBox& box) const {
    const Interval::Precision precision(bits);
    const EnclosedTape enclosed(tape_, needed_, box);
    const auto& all = enclosed.nodes();
    const EnclosedNode& hit = all[static_cast<std::size_t>(tape_.outputs.hit)];
    BoxBound bound;
    bound.misses = hit.exact_decision.is_no() || hit.computed_decision.is_no();
    bound.decides = !hit.exact_decision.is_unknown() && hit.exact_decision == hit.computed_decision;
    const EnclosedNode& t = all[static_cast<std::size_t>(tape_.outputs.t)];
    if (bound.misses || !t.known) return bound;
    bound.least = least_magnitude(t.exact);
    const auto slope = slopes(tape_, all);
    if (!slope) return bound;
    Interval error(0);
    for (std::size_t i = 0; i < all.size(); ++i)
        if (!is_zero((*slope)[i])) error = error + (*slope)[i] * all[i].rounding;
    if (error.is_bounded()) bound.error = std::fmin(largest_magnitude(error), largest_magnitude(t.computed - t.exact));
    return bound;
}

std::vector<double> TapeBound::shares(const InputBox& box) const {
    const Interval::Precision precision(bits);
    const EnclosedTape enclosed(tape_, needed_, box);
    const auto& all = enclosed.nodes();
    std::vector<double> made(all.size());
    const auto slope = slopes(tape_, all);
    for (std::size_t i = 0; slope && i < all.size(); ++i) made[i] = largest_magnitude((*slope)[i] * all[i].rounding);
    return made;
}

Subdivided::Subdivided(const TapeBound& bound, InputBox whole, std::size_t boxes,
                       const intersect::process::StopToken& stop) {
    free_ = static_cast<int>(std::ranges::count_if(whole, [](const InputRange& x) { return !x.is_point(); }));
    parts_.push_back({.bound = bound.over(whole)});
    parts_.front().box = std::move(whole);
    for (std::size_t leaves = 1; leaves < boxes;) {
        const auto chosen = boxes_to_halve(std::min((leaves + 3) / 4, boxes - leaves));
        if (chosen.empty()) break;
        halve(chosen, bound, stop);
        leaves += chosen.size();
    }
}

/// Boxes with the largest scores. The score is the volume times the bits by which the bound exceeds the smallest bound
/// of all boxes.
std::vector<std::size_t> Subdivided::boxes_to_halve(std::size_t at_most) const {
    double best = HUGE_VAL;
    for (const BoundedPart& p : parts_)
        if (!p.is_halved() && p.bound.error > 0) best = std::fmin(best, p.bound.error);
    std::vector<std::pair<double, std::size_t>> found;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const BoundedPart& p = parts_[i];
        if (p.is_halved() || p.bound.misses || p.bound.error == 0 || p.stale >= 2 * free_) continue;
        if (widest(p.box, parts_.front().box) < 0) continue;
        const double above = p.bound.error < HUGE_VAL ? 1 + std::log2(p.bound.error / best) : unknown_bits;
        found.emplace_back(-p.share * above, i);
    }
    std::ranges::sort(found);
    found.resize(std::min(at_most, found.size()));
    std::vector<std::size_t> chosen;
    for (const auto& [score, i] : found) chosen.push_back(i);
    return chosen;
}

void Subdivided::halve(std::span<const std::size_t> which, const TapeBound& bound,
                       const intersect::process::StopToken& stop) {
    const std::size_t first = parts_.size();
    for (const std::size_t i : which) {
        BoundedPart& p = parts_[i];
        p.axis = widest(p.box, parts_.front().box);
        InputRange& range = p.box[static_cast<std::size_t>(p.axis)];
        p.middle = range.low / 2 + range.high / 2;
        p.below = parts_.size();
        BoundedPart below = p, above = p;
        below.axis = above.axis = -1;
        below.share = above.share = p.share / 2;
        below.box[static_cast<std::size_t>(p.axis)].high = p.middle;
        above.box[static_cast<std::size_t>(p.axis)].low = p.middle;
        parts_.push_back(std::move(below));
        parts_.push_back(std::move(above));
    }
    intersect::process::in_parallel(first, parts_.size(), [&](std::size_t i) {
        stop.check();
        BoundedPart& p = parts_[i];
        const double before = p.bound.error;
        p.bound = bound.over(p.box);
        p.bound.error = std::fmin(p.bound.error, before);
        p.stale = p.bound.error > 0.98 * before ? p.stale + 1 : 0;
    });
}

const BoundedPart& Subdivided::part_of(std::span<const double> inputs) const {
    const BoundedPart* p = &parts_.front();
    while (p->is_halved()) p = &parts_[p->below + (inputs[static_cast<std::size_t>(p->axis)] > p->middle ? 1 : 0)];
    return *p;
}

std::vector<const BoundedPart*> Subdivided::leaves() const {
    std::vector<const BoundedPart*> all;
    for (const BoundedPart& p : parts_)
        if (!p.is_halved()) all.push_back(&p);
    return all;
}

}  // namespace lostbits::measure::apriori
