#include "measure/attribution/attribution.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "measure/attribution/exact_arithmetic.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/operations.hpp"
#include "measure/truth/lost_bits.hpp"

namespace lostbits::measure::attribution {
namespace {

/// Walks one tape in one exact arithmetic: forward for the exact values, backward for the adjoints.
template <class Exact>
class Walk {
public:
    using Number = typename Exact::Number;

    Walk(const Tape& tape, AttributionDepth depth) : tape_(tape), depth_(depth), exact_(tape.nodes.size(), Number(0)) {
        attribution_.errors.resize(tape.nodes.size());
        attribution_.exact_bits = Exact::bits;
        for (NodeId i = 0; i < tape.size(); ++i) find_value_and_error(i);
        attribution_.is_exact_hit = tape.outputs.hit != no_node && is_true(tape.outputs.hit);
    }

    [[nodiscard]] bool has_failed() const { return has_failed_; }
    [[nodiscard]] Attribution take_attribution() { return std::move(attribution_); }

    /// The form's t if its decision is the same without rounding, otherwise the decision.
    NodeId default_subject() {
        const NodeId hit = tape_.outputs.hit;
        return error_of(hit).decision_changed ? hit : tape_.outputs.t;
    }

    void attribute(NodeId subject) {
        if (is_decision(tape_[subject].op)) subject = first_changed_comparison(subject);
        attribution_.subject = subject;
        if (subject == no_node) return;
        seed(subject);
        for (NodeId i = subject; i >= 0; --i) pass_adjoint(i);
        for (NodeId i = 0; i <= subject; ++i) add_contribution(i);
        attribution_.error = is_decision(tape_[subject].op) ? error_of_difference(subject) : error_of(subject).error;
        if (const NodeId not_finite = not_finite_in(subject); not_finite != no_node)
            attribution_.culprit = origin_of_not_finite(not_finite);
        else choose_culprit();
    }

private:
    OperationError& error_of(NodeId i) { return attribution_.errors[i]; }
    Number& exact(NodeId i) { return exact_[i]; }
    [[nodiscard]] double computed(NodeId i) const { return tape_[i].value; }
    bool is_true(NodeId i) { return error_of(i).exact != 0; }

    bool decision_or_fail(const std::optional<bool>& decision, bool as_computed) {
        has_failed_ |= !decision.has_value();
        return decision.value_or(as_computed);
    }

    /// Decides by exact values, or as the format did if the exact values leave the decision open.
    struct ExactDecider {
        Walk& walk;
        const TapeNode& n;
        [[nodiscard]] bool less(std::size_t k, std::size_t l) const {
            const NodeId a = n.operands[k], b = n.operands[l];
            if (a == b) return false;
            return walk.decision_or_fail(Exact::less(walk.exact(a), walk.exact(b)),
                                         walk.computed(a) < walk.computed(b));
        }
        [[nodiscard]] bool less_equal(std::size_t k, std::size_t l) const {
            const NodeId a = n.operands[k], b = n.operands[l];
            return walk.decision_or_fail(Exact::less_equal(walk.exact(a), walk.exact(b)),
                                         walk.computed(a) <= walk.computed(b));
        }
        [[nodiscard]] bool holds(std::size_t k) const { return walk.is_true(n.operands[k]); }
    };

    void find_value_and_error(NodeId i) {
        const TapeNode& n = tape_[i];
        OperationError& e = error_of(i);
        if (is_decision(n.op)) return evaluate_decision(i);
        find_exact(i);
        if (n.op == TapeOp::input) {
            e.exact = n.value;  // infinity too: a ball holds it only as a large number
            return;
        }
        e.exact = Exact::nearest(exact(i));
        e.error = Exact::difference(n.value, exact(i));
        if (!e.decision_changed) e.rounding = rounding_of(tape_, i);
        e.cancelled_bits = cancellation(tape_, i);
        for (const NodeId operand : tape_.operands_of(i)) e.operands_have_error |= error_of(operand).error != 0;
        if (depth_.full) e.local_bits = local_bits(i);
    }

    void find_exact(NodeId i) {
        const TapeNode& n = tape_[i];
        switch (kind_of(n.op)) {
            case OperationKind::given:
            case OperationKind::rounded:
            case OperationKind::exact:
                exact(i) = evaluate_without_rounding<Exact>(
                    n, [&](std::size_t k) -> const Number& { return exact(n.operands[k]); });
                break;
            case OperationKind::called: evaluate_call(i); break;
            case OperationKind::next_or_converted: exact(i) = exact(n.operands[0]); break;
            case OperationKind::sign: evaluate_sign(i); break;
            case OperationKind::choice: evaluate_choice(i); break;
            case OperationKind::comparison:
            case OperationKind::logic: break;
        }
    }

    /// Finds the exact value of a call. If exact arguments leave its decision open, uses the computed result.
    void evaluate_call(NodeId i) {
        const auto value = result_of_call<Exact>(tape_, i, [this](NodeId k) { return exact(k); });
        has_failed_ |= !value;
        exact(i) = value ? *value : Exact::lift(computed(i));
    }

    void evaluate_decision(NodeId i) {
        const TapeNode& n = tape_[i];
        const bool computed_holds = n.value != 0, exact_holds = holds(n.op, ExactDecider{*this, n});
        error_of(i).exact = exact_holds;
        error_of(i).decision_changed = exact_holds != computed_holds;
        if (n.op == TapeOp::any && exact_holds && !computed_holds) attribution_.loop_was_cut_short = true;
    }

    /// Finds the exact value of a choice: that of the side that exact values choose. If the format chose another side,
    /// with another computed value, the choice's own error is the difference between the two sides.
    void evaluate_choice(NodeId i) {
        const TapeNode& n = tape_[i];
        const NodeId computed_side = chosen_side(tape_, i), exact_side = chosen_side(n, ExactDecider{*this, n});
        exact(i) = exact(exact_side);
        error_of(i).decision_changed =
            exact_side != computed_side && !have_same_bits(computed(exact_side), computed(computed_side));
        error_of(i).chosen_side = error_of(i).decision_changed ? computed_side : exact_side;
        if (!error_of(i).decision_changed) return;
        error_of(i).rounding = lacks_exact_value(computed_side)
                                   ? Exact::difference(n.value, exact(exact_side))
                                   : Exact::nearest(exact(computed_side) - exact(exact_side));
    }

    static bool have_same_bits(double a, double b) {
        return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    }

    /// True if a side that was chosen by mistake has no exact value,such as the root of a number that is negative
    /// without rounding. The whole error then belongs to the choice, and none comes from that side.
    bool lacks_exact_value(NodeId computed_side) {
        return !std::isfinite(error_of(computed_side).exact) && tape_[computed_side].op != TapeOp::input;
    }

    /// |a| with the sign of b; for a zero or NaN, the sign as computed.
    void evaluate_sign(NodeId i) {
        const auto [a, b, c] = tape_[i].operands;
        const double sign_source = Exact::nearest(exact(b));
        const bool was_negative = std::signbit(computed(b));
        bool negative = was_negative;
        if (sign_source != 0 && !std::isnan(sign_source))
            negative = decision_or_fail(Exact::less(exact(b), Number(0)), was_negative);
        const Number size = abs(exact(a));
        exact(i) = negative ? -size : size;
        error_of(i).decision_changed = negative != was_negative;
        if (negative != was_negative) error_of(i).rounding = Exact::nearest(was_negative ? -size - size : size + size);
    }

    double local_bits(NodeId i) {
        if constexpr (std::same_as<Exact, DeepExact>) {
            const TapeNode& n = tape_[i];
            switch (kind_of(n.op)) {
                case OperationKind::rounded:
                case OperationKind::sign: {
                    std::array<double, 3> x{};
                    for (std::size_t k = 0; k < row_of(n.op).operand_count; ++k)
                        x[k] = Exact::round_to(exact(n.operands[k]), tape_.format_of(n.operands[k]));
                    return bits_lost_by(i, result_of(n.op, x, tape_.format_of(i)));
                }

                case OperationKind::called:
                    return bits_lost_by(i, error_of(i).operands_have_error
                                               ? Exact::round_to(exact(i), tape_.format_of(i))
                                               : computed(i));

                case OperationKind::given:
                case OperationKind::exact:              // rounding the operand alone costs half an ulp, which is no bit
                case OperationKind::next_or_converted:  // its change is intended
                case OperationKind::choice:
                case OperationKind::comparison:
                case OperationKind::logic: break;
            }
        }
        return 0;
    }
    double bits_lost_by(NodeId i, double rerun) {
        const double error = Exact::difference(rerun, exact(i));
        if (!std::isfinite(error) || error == 0) return 0;
        const double size = std::fabs(error_of(i).exact);
        const long e = ulp_exponent(tape_.format_of(i), size == 0 ? -100000 : std::ilogb(size));
        return truth::lost_bits(std::ldexp(error, static_cast<int>(-e)), tape_.format_of(i).precision);
    }

    void seed(NodeId subject) {
        OperationError& e = error_of(subject);
        e.is_live = true;
        e.adjoint = e.derivative = 1;
    }

    /// Passes node i's adjoint on to its operands.
    void pass_adjoint(NodeId i) {
        const TapeNode& n = tape_[i];
        const OperationError& e = error_of(i);
        if (!e.is_live || is_given(n.op)) return;
        if (n.op == TapeOp::call) return pass_through_call(i);
        has_failed_ |= !is_decision(n.op) && !Exact::is_accurate_enough(exact(i), n.value);

        const NodeId computed_side = e.chosen_side;
        if (e.decision_changed && computed_side != no_node && lacks_exact_value(computed_side)) return;

        // Factors of the finite differences and, for a full attribution, of the derivatives at the computed values.
        std::array<OperandError, 3> differences{}, points{};

        for (std::size_t k = 0; k < row_of(n.op).operand_count; ++k) {
            if (is_decision(tape_[n.operands[k]].op)) continue;
            const double x = computed(n.operands[k]);
            differences[k] = {error_of(n.operands[k]).exact, x};
            points[k] = {x, x, true};
        }

        const ErrorFactors difference = error_factors_of(n, differences, computed_side);
        const ErrorFactors derivative = depth_.full ? error_factors_of(n, points, computed_side) : ErrorFactors{};

        for (std::size_t k = 0; k < row_of(n.op).operand_count; ++k) {
            if (!difference[k]) continue;
            OperationError& operand = error_of(n.operands[k]);
            operand.is_live = true;
            operand.adjoint += e.adjoint * *difference[k];
            if (depth_.full) operand.derivative += e.derivative * *derivative[k];
        }
    }

    void pass_through_call(NodeId i) {
        const auto arguments = tape_.operands_of(i);
        for (const NodeId k : arguments) error_of(k).is_live = true;
        if constexpr (std::same_as<Exact, DeepExact>) {
            std::vector<Number> exact_arguments, computed_arguments;
            for (const NodeId k : arguments) {
                exact_arguments.push_back(exact(k));
                computed_arguments.push_back(Number(computed(k)));
            }
            const CallSlopes slopes(tape_.call_at(i).callee, std::move(exact_arguments), computed_arguments);
            for (std::size_t k = 0; k < arguments.size(); ++k) {
                error_of(arguments[k]).adjoint += error_of(i).adjoint * slopes.quotients[k];
                error_of(arguments[k]).derivative += error_of(i).derivative * slopes.derivatives[k];
            }
        } else {
            has_failed_ |= std::ranges::any_of(arguments, [this](NodeId k) { return tape_[k].op != TapeOp::input; });
        }
    }

    void add_contribution(NodeId i) {
        OperationError& e = error_of(i);
        if (!e.is_live || e.rounding == 0) return;
        e.contribution = e.rounding * e.adjoint;
        attribution_.contribution_sum += e.contribution;
        if (depth_.full) attribution_.first_order_sum += e.rounding * e.derivative;
    }

    void choose_culprit() {
        attribution_.equal_culprits = find_culprit_and_equals(tape_, attribution_);
        if (attribution_.equal_culprits.empty()) return;
        attribution_.culprit = attribution_.equal_culprits.front();
        if (!(std::fabs(error_of(attribution_.culprit).contribution) > 0)) return attribution_.equal_culprits.clear();
        attribution_.equal_culprits.erase(attribution_.equal_culprits.begin());
    }

    /// (computed left − right) − (exact left − right) for a comparison.
    double error_of_difference(NodeId comparison) {
        const auto [a, b, c] = tape_[comparison].operands;
        return error_of(a).error - error_of(b).error;
    }

    /// The first comparison, in the order of the formula, that rounding changed.
    NodeId first_changed_comparison(NodeId decision) {
        while (decision != no_node && !is_comparison(tape_[decision].op)) {
            NodeId next = no_node;
            for (const NodeId operand : tape_[decision].operands) {
                if (operand != no_node && next == no_node && error_of(operand).decision_changed) next = operand;
            }
            decision = next;
        }
        return decision != no_node && error_of(decision).decision_changed ? decision : no_node;
    }

    /// For a number, the subject if it is not finite; for a comparison, the side that is not finite and would be finite
    /// without rounding; otherwise `no_node`.
    NodeId not_finite_in(NodeId subject) {
        if (!is_decision(tape_[subject].op)) return std::isfinite(computed(subject)) ? no_node : subject;
        for (const NodeId side : tape_[subject].operands) {
            if (side != no_node && !std::isfinite(computed(side)) && std::isfinite(error_of(side).exact) &&
                origin_of_not_finite(side) != no_node)
                return side;
        }
        return no_node;
    }

    /// The operation that made a value infinite or NaN although its own operands are finite.
    NodeId origin_of_not_finite(NodeId i) {
        for (;;) {
            const TapeNode& n = tape_[i];
            if (is_given(n.op)) return no_node;
            const NodeId computed_side = error_of(i).chosen_side;
            NodeId next = no_node;
            for (const NodeId operand : n.operands) {
                const bool follows = computed_side == no_node || operand == computed_side;
                if (operand != no_node && follows && next == no_node && !std::isfinite(computed(operand)))
                    next = operand;
            }
            if (next == no_node) return i;
            i = next;
        }
    }

    const Tape& tape_;
    AttributionDepth depth_;
    std::vector<Number> exact_;
    Attribution attribution_;
    bool has_failed_ = false;
};

template <class Subject>
Attribution attribute_by_walk(const Tape& tape, AttributionDepth depth, Subject subject) {
    if (!depth.full) {
        Walk<QuickExact> quick(tape, depth);
        if (!quick.has_failed()) quick.attribute(subject(quick));
        if (!quick.has_failed()) return quick.take_attribution();
    }
    Walk<DeepExact> deep(tape, depth);
    deep.attribute(subject(deep));
    return deep.take_attribution();
}

}  // namespace

bool is_plain_miss(const Tape& tape, const Attribution& attribution) {
    const NodeId hit = tape.outputs.hit;
    return hit != no_node && tape[hit].value == 0 && !attribution.is_exact_hit;
}

Attribution attribute(const Tape& tape, NodeId subject, AttributionDepth depth) {
    return attribute_by_walk(tape, depth, [subject](auto&) { return subject; });
}

Attribution attribute(const Tape& tape, AttributionDepth depth) {
    Attribution attribution = attribute_by_walk(tape, depth, [](auto& walk) { return walk.default_subject(); });
    if (is_plain_miss(tape, attribution)) {
        attribution.culprit = no_node;
        attribution.equal_culprits.clear();
    }
    return attribution;
}

}  // namespace lostbits::measure::attribution
