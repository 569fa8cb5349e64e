#include "measure/attribution/rerun.hpp"

#include <algorithm>
#include <utility>

#include "measure/attribution/exact_arithmetic.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/operations.hpp"

namespace lostbits::measure::attribution {
namespace {

using Number = DeepExact::Number;

class Run {
public:
    Run(const Tape& tape, std::function<bool(NodeId)> rounds) : tape_(tape), rounds_(std::move(rounds)) {
        for (NodeId i = 0; i < tape.size(); ++i) values_.push_back(result(i, *this));
    }
    /// Takes the run that the tape recorded.
    explicit Run(const Tape& tape) : tape_(tape), rounds_([](NodeId) { return true; }) {
        for (const TapeNode& n : tape.nodes) values_.emplace_back(n.value);
    }
    /// Runs as `most`, but `operation` rounds, or chooses, as in `one`. Recomputes only what depends on it.
    Run(const Run& most, const Run& one, NodeId operation) : Run(most) {
        std::vector<bool> moved(values_.size());
        for (NodeId i = operation; i < tape_.size(); ++i) {
            const auto is_moved = [&](NodeId operand) { return moved[static_cast<std::size_t>(operand)]; };
            if (i != operation && std::ranges::none_of(tape_.operands_of(i), is_moved)) continue;
            moved[static_cast<std::size_t>(i)] = true;
            values_[static_cast<std::size_t>(i)] = result(i, i == operation ? one : *this);
        }
    }
    [[nodiscard]] const Number& value(NodeId i) const { return values_[static_cast<std::size_t>(i)]; }

private:
    struct Judge {
        const Run& run;
        const TapeNode& n;
        [[nodiscard]] bool less(std::size_t k, std::size_t l) const {
            return *DeepExact::less(run.value(n.operands[k]), run.value(n.operands[l]));
        }
        [[nodiscard]] bool less_equal(std::size_t k, std::size_t l) const {
            return *DeepExact::less_equal(run.value(n.operands[k]), run.value(n.operands[l]));
        }
        [[nodiscard]] bool holds(std::size_t k) const { return run.value(n.operands[k]) != 0; }
    };

    /// Result of node i from the operands of this run. `as` decides whether it rounds, and by which values it chooses.
    [[nodiscard]] Number result(NodeId i, const Run& as) const {
        const TapeNode& n = tape_[i];
        switch (kind_of(n.op)) {
            case OperationKind::given:
            case OperationKind::rounded: {
                const Number exact = without_rounding(n);
                return as.rounds_(i) ? Number(DeepExact::round_to(exact, tape_.format_of(i))) : exact;
            }
            case OperationKind::called: return called(i, as);
            case OperationKind::exact: return without_rounding(n);
            case OperationKind::moved: return as.rounds_(i) ? moved(i) : value(n.operands[0]);
            case OperationKind::sign: {
                const Number size = abs(value(n.operands[0]));
                return signbit(as.value(n.operands[1])) != 0 ? Number(-size) : size;
            }
            case OperationKind::choice: return value(side_taken(n, Judge{as, n}));
            case OperationKind::comparison:
            case OperationKind::logic: return Number(holds(n.op, Judge{as, n}) ? 1 : 0);
        }
        return {};
    }
    [[nodiscard]] Number without_rounding(const TapeNode& n) const {
        return attribution::without_rounding<DeepExact>(
            n, [&](std::size_t k) -> const Number& { return value(n.operands[k]); });
    }
    /// Result of a call. If its arguments are those of the tape, it is the value on the tape, because the function
    /// itself may be some units in the last place off.
    [[nodiscard]] Number called(NodeId i, const Run& as) const {
        const bool same =
            std::ranges::all_of(tape_.operands_of(i), [&](NodeId k) { return value(k) == Number(tape_[k].value); });
        if (same && as.rounds_(i)) return Number(tape_[i].value);
        const auto exact = attribution::result_of_call<DeepExact>(tape_, i, [&](NodeId k) { return value(k); });
        if (!exact) return Number(tape_[i].value);
        return as.rounds_(i) ? Number(DeepExact::round_to(*exact, tape_.format_of(i))) : *exact;
    }
    /// Moves to the next number or to another format. Operands that are not numbers of their format are rounded to it
    /// first.
    [[nodiscard]] Number moved(NodeId i) const {
        const TapeNode& n = tape_[i];
        const Number& x = value(n.operands[0]);
        if (n.op == TapeOp::convert) return Number(DeepExact::round_to(x, tape_.format_of(i)));
        return Number(result_of(n.op, {DeepExact::round_to(x, tape_.format_of(n.operands[0]))}, tape_.format_of(i)));
    }

    const Tape& tape_;
    std::function<bool(NodeId)> rounds_;
    std::vector<Number> values_;
};

Counterfactual difference(const Tape& tape, const Run& run, const Run& exact) {
    const auto [hit, t, near, far] = tape.outputs;
    return {.hit = hit == no_node || run.value(hit) != 0, .error = DeepExact::nearest(run.value(t) - exact.value(t))};
}

}  // namespace

Rerun::Rerun(const Tape& tape, const std::function<bool(NodeId)>& rounds) {
    const Run run(tape, rounds);
    for (NodeId i = 0; i < tape.size(); ++i) values.push_back(DeepExact::nearest(run.value(i)));
}

Counterfactuals counterfactuals(const Tape& tape, NodeId operation) {
    const Run computed(tape), exact(tape, [](NodeId) { return false; });
    return {difference(tape, Run(computed, exact, operation), exact),
            difference(tape, Run(exact, computed, operation), exact)};
}

}  // namespace lostbits::measure::attribution
