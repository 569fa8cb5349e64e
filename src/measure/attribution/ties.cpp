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
void for_each_source(const Tape& tape, const Attribution& attribution, NodeId i, const F& f) {
    const TapeNode& n = tape[i];
    if (is_given(n.op)) return;
    if (n.op == TapeOp::call) return static_cast<void>(std::ranges::for_each(tape.operands_of(i), f));
    const ErrorFactors quotients = error_factors_of(n, {}, attribution[i].chosen_side);
    for (std::size_t k = 0; k < quotients.size(); ++k) {
        if (quotients[k]) f(n.operands[k]);
    }
}

/// Positions of the nodes on the way to the subject. The positions do not depend on the order of the tape.
class NodePositions {
public:
    NodePositions(const Tape& tape, const Attribution& attribution)
        : tape_(tape),
          attribution_(attribution),
          distances_(tape.nodes.size()),
          positions_(tape.nodes.size(), unnumbered) {
        for (NodeId i = attribution.subject; i >= 0; --i) {
            if (!attribution[i].is_live) continue;
            for_each_source(tape, attribution, i, [&](NodeId source) {
                distances_[source] = std::max(distances_[source], distances_[i] + 1);
            });
        }
        number_nodes(attribution.subject);
    }

    [[nodiscard]] auto position_of(NodeId i) const { return std::tuple(distances_[i], positions_[i]); }

private:
    static constexpr int unnumbered = -1;

    /// Numbers the nodes from the answer down, operands from left to right. Not recursive: a march is thousands of
    /// operations deep.
    void number_nodes(NodeId subject) {
        int next_position = 0;
        std::vector<NodeId> pending{subject};
        while (!pending.empty()) {
            const NodeId i = pending.back();
            pending.pop_back();
            if (positions_[i] != unnumbered) continue;
            positions_[i] = next_position++;
            const auto old_size = static_cast<std::ptrdiff_t>(pending.size());
            for_each_source(tape_, attribution_, i, [&](NodeId source) { pending.push_back(source); });
            std::reverse(pending.begin() + old_size, pending.end());
        }
    }

    const Tape& tape_;
    const Attribution& attribution_;
    std::vector<int> distances_;  ///< number of operations up to the subject, on the longest path
    std::vector<int> positions_;  ///< position in reading order
};

bool are_wrong_choices_that_cancel(const Attribution& attribution, const std::vector<NodeId>& equals) {
    double sum = 0, largest = 0;
    for (const NodeId i : equals) {
        const OperationError& e = attribution[i];
        if (!e.decision_changed) return false;
        sum += e.contribution;
        largest = std::max(largest, std::fabs(e.contribution));
    }
    return equals.size() > 1 && std::fabs(sum) <= equal_contribution_tolerance * largest;
}

}  // namespace

std::vector<NodeId> find_largest_contributions(const Tape& tape, const Attribution& attribution,
                                               std::optional<double> below) {
    // NaN counts as −1, so it comes after all numbers.
    const auto size = [&](NodeId i) {
        const double contribution = attribution[i].contribution;
        return std::isnan(contribution) ? -1 : std::fabs(contribution);
    };
    const auto is_considered = [&](NodeId i) {
        const OperationError& e = attribution[i];
        return e.is_live && e.rounding != 0 && !(below && size(i) >= *below);
    };

    // Finds the largest contribution, and all that equal it within the tolerance.
    double largest = -1;
    for (NodeId i = 0; i <= attribution.subject; ++i) {
        if (is_considered(i)) largest = std::max(largest, size(i));
    }
    const double least = std::min(largest, largest * (1 - equal_contribution_tolerance));
    std::vector<NodeId> equals;
    for (NodeId i = 0; i <= attribution.subject; ++i) {
        if (is_considered(i) && size(i) >= least) equals.push_back(i);
    }

    if (equals.size() < 2) return equals;
    NodePositions positions(tape, attribution);
    std::ranges::sort(equals, {}, [&](NodeId i) { return positions.position_of(i); });
    return equals;
}

std::vector<NodeId> find_culprit_and_equals(const Tape& tape, const Attribution& attribution) {
    const std::vector<NodeId> largest = find_largest_contributions(tape, attribution);
    std::vector<NodeId> equals = largest;
    while (are_wrong_choices_that_cancel(attribution, equals)) {
        double least = HUGE_VAL;
        for (const NodeId i : equals) least = std::min(least, std::fabs(attribution[i].contribution));
        equals = find_largest_contributions(tape, attribution, least);
    }
    const bool has_contribution = !equals.empty() && attribution[equals.front()].contribution != 0;
    return has_contribution ? equals : largest;
}

bool is_computed_from(const Tape& tape, const Attribution& attribution, NodeId i, NodeId from) {
    std::vector<bool> is_reached(tape.nodes.size());
    const auto mark = [&](NodeId k) { is_reached[k] = true; };
    mark(i);
    for (; i > from; --i) {
        if (is_reached[i] && attribution[i].is_live) for_each_source(tape, attribution, i, mark);
    }
    return is_reached[from];
}

}  // namespace lostbits::measure::attribution
