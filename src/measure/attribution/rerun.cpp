#include "measure/attribution/rerun.hpp"

#include <algorithm>
#include <utility>

#include "measure/attribution/exact_arithmetic.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/operations.hpp"

namespace lostbits::measure::attribution {
namespace {

using Number = DeepExact::Number;

class ExactRun {
public:
    ExactRun(const Tape& tape, std::function<bool(NodeId)> is_rounded)
        : tape_(tape), is_rounded_(std::move(is_rounded)) {
        for (NodeId i = 0; i < tape.size(); ++i) values_.push_back(result(i, *this));
    }
    /// The run that the tape recorded.
    explicit ExactRun(const Tape& tape) : tape_(tape), is_rounded_([](NodeId) { return true; }) {
        for (const TapeNode& node : tape.nodes) values_.emplace_back(node.value);
    }

    /// Runs as `base`, except that `operation` rounds, or chooses, as in `other`. Recomputes only what depends on
    /// `operation`.
    ExactRun(const ExactRun& base, const ExactRun& other, NodeId operation) : ExactRun(base) {
        std::vector<bool> is_changed(values_.size());
        for (NodeId i = operation; i < tape_.size(); ++i) {
            const auto has_changed = [&](NodeId operand) { return is_changed[operand]; };
            if (i != operation && std::ranges::none_of(tape_.operands_of(i), has_changed)) continue;
            is_changed[i] = true;
            values_[i] = result(i, i == operation ? other : *this);
        }
    }
    [[nodiscard]] const Number& value(NodeId i) const { return values_[i]; }

private:
    struct Decider {
        const ExactRun& run;
        const TapeNode& n;
        [[nodiscard]] bool less(std::size_t k, std::size_t l) const {
            return *DeepExact::less(run.value(n.operands[k]), run.value(n.operands[l]));
        }
        [[nodiscard]] bool less_equal(std::size_t k, std::size_t l) const {
            return *DeepExact::less_equal(run.value(n.operands[k]), run.value(n.operands[l]));
        }
        [[nodiscard]] bool holds(std::size_t k) const { return run.value(n.operands[k]) != 0; }
    };

    /// Result of node i. `decider` is the run that decides whether the node rounds and which operand a choice takes;
    /// the operands' values are of this run.
    [[nodiscard]] Number result(NodeId i, const ExactRun& decider) const {
        const TapeNode& n = tape_[i];
        switch (kind_of(n.op)) {
            case OperationKind::given:
            case OperationKind::rounded: {
                const Number exact = evaluate_without_rounding(n);
                return decider.is_rounded_(i) ? Number(DeepExact::round_to(exact, tape_.format_of(i))) : exact;
            }
            case OperationKind::called: return call_result(i, decider);
            case OperationKind::exact: return evaluate_without_rounding(n);
            case OperationKind::next_or_converted:
                return decider.is_rounded_(i) ? moved_number(i) : value(n.operands[0]);
            case OperationKind::sign: {
                const Number size = abs(value(n.operands[0]));
                return signbit(decider.value(n.operands[1])) != 0 ? Number(-size) : size;
            }
            case OperationKind::choice: return value(chosen_side(n, Decider{decider, n}));
            case OperationKind::comparison:
            case OperationKind::logic: return Number(holds(n.op, Decider{decider, n}) ? 1 : 0);
        }
        return {};
    }
    [[nodiscard]] Number evaluate_without_rounding(const TapeNode& node) const {
        return attribution::evaluate_without_rounding<DeepExact>(
            node, [&](std::size_t k) -> const Number& { return value(node.operands[k]); });
    }
    /// Result of a call. If the arguments are those of the tape, the result is the value on the tape, because the
    /// function itself may be some units in the last place off.
    [[nodiscard]] Number call_result(NodeId i, const ExactRun& decider) const {
        const bool has_tape_arguments =
            std::ranges::all_of(tape_.operands_of(i), [&](NodeId k) { return value(k) == Number(tape_[k].value); });
        if (has_tape_arguments && decider.is_rounded_(i)) return Number(tape_[i].value);
        const auto exact = attribution::result_of_call<DeepExact>(tape_, i, [&](NodeId k) { return value(k); });
        if (!exact) return Number(tape_[i].value);
        return decider.is_rounded_(i) ? Number(DeepExact::round_to(*exact, tape_.format_of(i))) : *exact;
    }
    /// Moves to the next number or to another format. Operands that are not numbers of their format are rounded to it
    /// first.
    [[nodiscard]] Number moved_number(NodeId i) const {
        const TapeNode& n = tape_[i];
        const Number& x = value(n.operands[0]);
        if (n.op == TapeOp::convert) return Number(DeepExact::round_to(x, tape_.format_of(i)));
        return Number(result_of(n.op, {DeepExact::round_to(x, tape_.format_of(n.operands[0]))}, tape_.format_of(i)));
    }

    const Tape& tape_;
    std::function<bool(NodeId)> is_rounded_;
    std::vector<Number> values_;
};

Counterfactual compare_with_exact(const Tape& tape, const ExactRun& run, const ExactRun& exact) {
    const auto [hit, t, near, far] = tape.outputs;
    return {.hit = hit == no_node || run.value(hit) != 0, .error = DeepExact::nearest(run.value(t) - exact.value(t))};
}

}  // namespace

Rerun::Rerun(const Tape& tape, const std::function<bool(NodeId)>& is_rounded) {
    const ExactRun run(tape, is_rounded);
    for (NodeId i = 0; i < tape.size(); ++i) values.push_back(DeepExact::nearest(run.value(i)));
}

Counterfactuals run_counterfactuals(const Tape& tape, NodeId operation) {
    const ExactRun computed(tape), exact(tape, [](NodeId) { return false; });
    return {compare_with_exact(tape, ExactRun(computed, exact, operation), exact),
            compare_with_exact(tape, ExactRun(exact, computed, operation), exact)};
}

}  // namespace lostbits::measure::attribution
