// Chooses the culprit among several operations with the same contribution.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "measure/attribution/attribution.hpp"
#include "measure/attribution/operation_error.hpp"

namespace lostbits::measure::attribution {

namespace {

/// Calls f(operand) for each operand whose error goes through node i, in the order of the formula.
template <class F>
void for_each_source(const Tape& tape, NodeId i, const F& f) {
    const TapeNode& n = tape[i];
    if (is_given(n.op)) return;
    if (n.op == TapeOp::call) return static_cast<void>(std::ranges::for_each(tape.operands_of(i), f));
    const Quotients passes = quotients_of(n, {}, side_taken(tape, i));
    for (std::size_t k = 0; k < passes.size(); ++k) {
        if (passes[k]) f(n.operands[k]);
    }
}

/// Positions of the nodes on the way to the subject; they do not depend on the order of the tape.
class NodePositions {
public:
    NodePositions(const Tape& tape, const Attribution& found)
        : tape_(tape), steps_(tape.nodes.size()), read_(tape.nodes.size(), not_read) {
        for (NodeId i = found.subject; i >= 0; --i) {
            if (!found[i].live) continue;
            for_each_source(
                tape, i, [&](NodeId source) { at(steps_, source) = std::max(at(steps_, source), at(steps_, i) + 1); });
        }
        read(found.subject);
    }

    [[nodiscard]] auto position_of(NodeId i) { return std::tuple(at(steps_, i), at(read_, i)); }

private:
    static constexpr int not_read = -1;
    static int& at(std::vector<int>& of, NodeId i) { return of[static_cast<std::size_t>(i)]; }

    /// Numbers the nodes from the answer down, operands from left to right. Not recursive: a march is thousands of
    /// operations deep.
    void read(NodeId subject) {
        int place = 0;
        std::vector<NodeId> left{subject};
        while (!left.empty()) {
            const NodeId i = left.back();
            left.pop_back();
            if (at(read_, i) != not_read) continue;
            at(read_, i) = place++;
            const auto before = static_cast<std::ptrdiff_t>(left.size());
            for_each_source(tape_, i, [&](NodeId source) { left.push_back(source); });
            std::reverse(left.begin() + before, left.end());
        }
    }

    const Tape& tape_;
    std::vector<int> steps_;  ///< number of operations up to the subject, on the longest path
    std::vector<int> read_;   ///< position in reading order
};

bool are_wrong_choices_undone(const Attribution& found, const std::vector<NodeId>& equals) {
    double sum = 0, largest = 0;
    for (const NodeId i : equals) {
        const OperationError& e = found[i];
        if (!e.turned) return false;
        sum += e.contribution;
        largest = std::max(largest, std::fabs(e.contribution));
    }
    return equals.size() > 1 && std::fabs(sum) <= equal_contributions * largest;
}

}  // namespace

std::vector<NodeId> largest_contributions(const Tape& tape, const Attribution& found, std::optional<double> below) {
    // NaN has no magnitude, and comes after all numbers.
    const auto size = [&](NodeId i) {
        const double contribution = found[i].contribution;
        return std::isnan(contribution) ? -1 : std::fabs(contribution);
    };
    const auto counts = [&](NodeId i) {
        const OperationError& e = found[i];
        return e.live && e.rounding != 0 && !(below && size(i) >= *below);
    };
    double largest = -1;
    for (NodeId i = 0; i <= found.subject; ++i) {
        if (counts(i)) largest = std::max(largest, size(i));
    }
    const double least = std::min(largest, largest * (1 - equal_contributions));
    std::vector<NodeId> equals;
    for (NodeId i = 0; i <= found.subject; ++i) {
        if (counts(i) && size(i) >= least) equals.push_back(i);
    }
    if (equals.size() < 2) return equals;
    NodePositions positions(tape, found);
    std::ranges::sort(equals, {}, [&](NodeId i) { return positions.position_of(i); });
    return equals;
}

std::vector<NodeId> culprit_and_equals(const Tape& tape, const Attribution& found) {
    const std::vector<NodeId> largest = largest_contributions(tape, found);
    std::vector<NodeId> equals = largest;
    while (are_wrong_choices_undone(found, equals)) {
        double least = HUGE_VAL;
        for (const NodeId i : equals) least = std::min(least, std::fabs(found[i].contribution));
        equals = largest_contributions(tape, found, least);
    }
    const bool any = !equals.empty() && found[equals.front()].contribution != 0;
    return any ? equals : largest;
}

bool is_computed_from(const Tape& tape, const Attribution& found, NodeId i, NodeId from) {
    std::vector<bool> reached(tape.nodes.size());
    const auto mark = [&](NodeId k) { reached[static_cast<std::size_t>(k)] = true; };
    mark(i);
    for (; i > from; --i) {
        if (reached[static_cast<std::size_t>(i)] && found[i].live) for_each_source(tape, i, mark);
    }
    return reached[static_cast<std::size_t>(from)];
}

}  // namespace lostbits::measure::attribution
