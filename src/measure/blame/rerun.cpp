#include "measure/blame/rerun.hpp"

#include <utility>

#include "measure/blame/exact_arithmetic.hpp"
#include "measure/blame/operation_error.hpp"
#include "measure/blame/operations.hpp"

namespace lostbits::measure::blame {
namespace {

using Number = DeepExact::Number;

class Run {
public:
    Run(const Tape& tape, std::function<bool(NodeId)> rounds) : tape_(tape), rounds_(std::move(rounds)) {
        for (NodeId i = 0; i < tape.size(); ++i) values_.push_back(is_decision(tape[i].op) ? decided(i) : made(i));
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

    Number decided(NodeId i) const { return Number(holds(tape_[i].op, Judge{*this, tape_[i]}) ? 1 : 0); }

    Number made(NodeId i) const {
        const TapeNode& n = tape_[i];
        const auto exactly = [&]<TapeOp op>() -> Number {
            return with_operands<op>(
                [](const auto&... x) -> Number { return Operation<op>::template exact<DeepExact>(x...); },
                [&](std::size_t k) -> const Number& { return value(n.operands[k]); });
        };
        switch (kind_of(n.op)) {
            case OperationKind::given:
                return rounded(i, with<OperationKind::given>(n.op, [&]<TapeOp op>() -> Number {
                                   return Operation<op>::template exact<DeepExact>(n);
                               }));
            case OperationKind::rounded: return rounded(i, with<OperationKind::rounded>(n.op, exactly));
            case OperationKind::exact: return with<OperationKind::exact>(n.op, exactly);
            case OperationKind::moved: return moved(i);
            case OperationKind::sign: {
                const Number size = abs(value(n.operands[0]));
                return signbit(value(n.operands[1])) != 0 ? Number(-size) : size;
            }
            case OperationKind::choice: return value(side_taken(n, Judge{*this, n}));
            case OperationKind::comparison:
            case OperationKind::logic: break;
        }
        return {};
    }
    Number rounded(NodeId i, const Number& x) const {
        return rounds_(i) ? Number(DeepExact::round_to(x, tape_.format_of(i))) : x;
    }
    /// Of what is no number of its format, that of the nearest.
    Number moved(NodeId i) const {
        const TapeNode& n = tape_[i];
        const Number& x = value(n.operands[0]);
        if (!rounds_(i)) return x;
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
    const Run exact(tape, [](NodeId) { return false; });
    const Run mended(tape, [operation](NodeId i) { return i != operation; });
    const Run alone(tape, [operation](NodeId i) { return i == operation; });
    return {difference(tape, mended, exact), difference(tape, alone, exact)};
}

}  // namespace lostbits::measure::blame
