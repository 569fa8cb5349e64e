#include "measure/attribution/attribution.hpp"

#include <algorithm>
#include <cmath>

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
        found_.errors.resize(tape.nodes.size());
        found_.exact_bits = Exact::bits;
        for (NodeId i = 0; i < tape.size(); ++i) forward(i);
        found_.exact_hit = tape.outputs.hit != no_node && is_true(tape.outputs.hit);
    }

    [[nodiscard]] bool failed() const { return failed_; }
    [[nodiscard]] Attribution take() { return std::move(found_); }

    /// The form's t if its decision is the same without rounding, otherwise the decision.
    NodeId natural_subject() {
        const NodeId hit = tape_.outputs.hit;
        return of(hit).turned ? hit : tape_.outputs.t;
    }

    void attribute(NodeId subject) {
        if (is_decision(tape_[subject].op)) subject = turned_comparison(subject);
        found_.subject = subject;
        if (subject == no_node) return;
        seed(subject);
        for (NodeId i = subject; i >= 0; --i) backward(i);
        for (NodeId i = 0; i <= subject; ++i) sum_up(i);
        found_.error = is_decision(tape_[subject].op) ? apart(subject) : of(subject).error;
        if (const NodeId broken = no_number_in(subject); broken != no_node) found_.culprit = origin(broken);
        else choose_culprit();
    }

private:
    OperationError& of(NodeId i) { return found_.errors[static_cast<std::size_t>(i)]; }
    Number& exact(NodeId i) { return exact_[static_cast<std::size_t>(i)]; }
    [[nodiscard]] double computed(NodeId i) const { return tape_[i].value; }
    bool is_true(NodeId i) { return of(i).exact != 0; }

    bool settled(const std::optional<bool>& decision, bool as_computed) {
        failed_ |= !decision.has_value();
        return decision.value_or(as_computed);
    }

    /// Decides by exact values, and as the format did if those leave the decision open.
    struct ExactJudge {
        Walk& walk;
        const TapeNode& n;
        [[nodiscard]] bool less(std::size_t k, std::size_t l) const {
            const NodeId a = n.operands[k], b = n.operands[l];
            if (a == b) return false;
            return walk.settled(Exact::less(walk.exact(a), walk.exact(b)), walk.computed(a) < walk.computed(b));
        }
        [[nodiscard]] bool less_equal(std::size_t k, std::size_t l) const {
            const NodeId a = n.operands[k], b = n.operands[l];
            return walk.settled(Exact::less_equal(walk.exact(a), walk.exact(b)), walk.computed(a) <= walk.computed(b));
        }
        [[nodiscard]] bool holds(std::size_t k) const { return walk.is_true(n.operands[k]); }
    };

    void forward(NodeId i) {
        const TapeNode& n = tape_[i];
        OperationError& e = of(i);
        if (is_decision(n.op)) return decide(i);
        find_exact(i);
        if (n.op == TapeOp::input) {
            e.exact = n.value;  // infinity too: a ball holds it only as a large number
            return;
        }
        e.exact = Exact::nearest(exact(i));
        e.error = Exact::difference(n.value, exact(i));
        if (!e.turned) e.rounding = rounding_of(tape_, i);
        e.cancelled = cancellation(tape_, i);
        for (const NodeId operand : tape_.operands_of(i)) e.carried |= of(operand).error != 0;
        if (depth_.full) e.local_bits = local_bits(i);
    }

    void find_exact(NodeId i) {
        const TapeNode& n = tape_[i];
        switch (kind_of(n.op)) {
            case OperationKind::given:
            case OperationKind::rounded:
            case OperationKind::exact:
                exact(i) =
                    without_rounding<Exact>(n, [&](std::size_t k) -> const Number& { return exact(n.operands[k]); });
                break;
            case OperationKind::called: call(i); break;
            case OperationKind::moved: exact(i) = exact(n.operands[0]); break;
            case OperationKind::sign: sign(i); break;
            case OperationKind::choice: choose(i); break;
            case OperationKind::comparison:
            case OperationKind::logic: break;
        }
    }

    /// Takes the exact value of a call. If exact arguments leave its decision open, takes the computed result.
    void call(NodeId i) {
        const auto value = result_of_call<Exact>(tape_, i, [this](NodeId k) { return exact(k); });
        failed_ |= !value;
        exact(i) = value ? *value : Exact::lift(computed(i));
    }

    void decide(NodeId i) {
        const TapeNode& n = tape_[i];
        const bool was = n.value != 0, is = holds(n.op, ExactJudge{*this, n});
        of(i).exact = is;
        of(i).turned = is != was;
        if (n.op == TapeOp::any && is && !was) found_.cut_short = true;
    }

    /// The exact value of a choice is that of the side that exact values choose. If another side was taken, the
    /// choice's own error is the difference between the two sides.
    void choose(NodeId i) {
        const TapeNode& n = tape_[i];
        const NodeId taken = side_taken(tape_, i), meant = side_taken(n, ExactJudge{*this, n});
        exact(i) = exact(meant);
        of(i).turned = meant != taken;
        if (meant == taken) return;
        of(i).rounding =
            is_cut(taken) ? Exact::difference(n.value, exact(meant)) : Exact::nearest(exact(taken) - exact(meant));
    }

    /// True if a side that was taken by mistake has no exact value (such as the root of a number that is negative
    /// without rounding). The whole error is then the choice's, and none comes from that side.
    bool is_cut(NodeId taken) { return !std::isfinite(of(taken).exact) && tape_[taken].op != TapeOp::input; }

    /// |a| with the sign of b; for a zero or NaN, the sign as computed.
    void sign(NodeId i) {
        const auto [a, b, c] = tape_[i].operands;
        const double by = Exact::nearest(exact(b));
        const bool was = std::signbit(computed(b));
        bool negative = was;
        if (by != 0 && !std::isnan(by)) negative = settled(Exact::less(exact(b), Number(0)), was);
        const Number size = abs(exact(a));
        exact(i) = negative ? -size : size;
        of(i).turned = negative != was;
        if (negative != was) of(i).rounding = Exact::nearest(was ? -size - size : size + size);
    }

    double local_bits(NodeId i) {
        if constexpr (std::same_as<Exact, DeepExact>) {
            const TapeNode& n = tape_[i];
            switch (kind_of(n.op)) {
                case OperationKind::rounded:
                case OperationKind::sign: {
                    std::array<double, 3> x{};
                    for (std::size_t k = 0; k < row_of(n.op).operands; ++k)
                        x[k] = Exact::round_to(exact(n.operands[k]), tape_.format_of(n.operands[k]));
                    return bits_off(i, result_of(n.op, x, tape_.format_of(i)));
                }
                case OperationKind::called:
                    return bits_off(i, of(i).carried ? Exact::round_to(exact(i), tape_.format_of(i)) : computed(i));
                case OperationKind::given:
                case OperationKind::exact:  // rounding the operand alone costs half an ulp, which is no bit
                case OperationKind::moved:  // its change is intended
                case OperationKind::choice:
                case OperationKind::comparison:
                case OperationKind::logic: break;
            }
        }
        return 0;
    }
    double bits_off(NodeId i, double rerun) {
        const double off = Exact::difference(rerun, exact(i));
        if (!std::isfinite(off) || off == 0) return 0;
        const double size = std::fabs(of(i).exact);
        const long e = ulp_exponent(tape_.format_of(i), size == 0 ? -100000 : std::ilogb(size));
        return truth::lost_bits(std::ldexp(off, static_cast<int>(-e)), tape_.format_of(i).precision);
    }

    void seed(NodeId subject) {
        OperationError& e = of(subject);
        e.live = true;
        e.adjoint = e.derivative = 1;
    }

    /// Passes node i's adjoint on to its operands.
    void backward(NodeId i) {
        const TapeNode& n = tape_[i];
        const OperationError& e = of(i);
        if (!e.live || is_given(n.op)) return;
        if (n.op == TapeOp::call) return through_call(i);
        failed_ |= !is_decision(n.op) && !Exact::is_good(exact(i), n.value);
        const NodeId taken = side_taken(tape_, i);
        if (e.turned && taken != no_node && is_cut(taken)) return;
        std::array<Step, 3> differences{}, points{};
        for (std::size_t k = 0; k < row_of(n.op).operands; ++k) {
            if (is_decision(tape_[n.operands[k]].op)) continue;
            const double x = computed(n.operands[k]);
            differences[k] = {of(n.operands[k]).exact, x};
            points[k] = {x, x, true};
        }
        const Quotients difference = quotients_of(n, differences, taken);
        const Quotients derivative = depth_.full ? quotients_of(n, points, taken) : Quotients{};
        for (std::size_t k = 0; k < row_of(n.op).operands; ++k) {
            if (!difference[k]) continue;
            OperationError& operand = of(n.operands[k]);
            operand.live = true;
            operand.adjoint += e.adjoint * *difference[k];
            if (depth_.full) operand.derivative += e.derivative * *derivative[k];
        }
    }

    void through_call(NodeId i) {
        const auto arguments = tape_.operands_of(i);
        for (const NodeId k : arguments) of(k).live = true;
        if constexpr (std::same_as<Exact, DeepExact>) {
            std::vector<Number> from, to;
            for (const NodeId k : arguments) from.push_back(exact(k)), to.push_back(Number(computed(k)));
            const CallSlopes slopes(tape_.call_at(i).of, std::move(from), to);
            for (std::size_t k = 0; k < arguments.size(); ++k) {
                of(arguments[k]).adjoint += of(i).adjoint * slopes.quotients[k];
                of(arguments[k]).derivative += of(i).derivative * slopes.derivatives[k];
            }
        } else {
            failed_ |= std::ranges::any_of(arguments, [this](NodeId k) { return tape_[k].op != TapeOp::input; });
        }
    }

    void sum_up(NodeId i) {
        OperationError& e = of(i);
        if (!e.live || e.rounding == 0) return;
        e.contribution = e.rounding * e.adjoint;
        found_.explained += e.contribution;
        if (depth_.full) found_.first_order += e.rounding * e.derivative;
    }

    void choose_culprit() {
        found_.equals = culprit_and_equals(tape_, found_);
        if (found_.equals.empty()) return;
        found_.culprit = found_.equals.front();
        if (!(std::fabs(of(found_.culprit).contribution) > 0)) return found_.equals.clear();
        found_.equals.erase(found_.equals.begin());
    }

    /// (computed left − right) − (exact left − right) for a comparison.
    double apart(NodeId comparison) {
        const auto [a, b, c] = tape_[comparison].operands;
        return of(a).error - of(b).error;
    }

    /// The first comparison, in the order of the formula, whose decision differs from the exact one.
    NodeId turned_comparison(NodeId decision) {
        while (decision != no_node && !is_comparison(tape_[decision].op)) {
            NodeId next = no_node;
            for (const NodeId operand : tape_[decision].operands) {
                if (operand != no_node && next == no_node && of(operand).turned) next = operand;
            }
            decision = next;
        }
        return decision != no_node && of(decision).turned ? decision : no_node;
    }

    /// The subject if it is not finite. For a comparison, the side that is not finite and would be finite without
    /// rounding.
    NodeId no_number_in(NodeId subject) {
        if (!is_decision(tape_[subject].op)) return std::isfinite(computed(subject)) ? no_node : subject;
        for (const NodeId side : tape_[subject].operands) {
            if (side != no_node && !std::isfinite(computed(side)) && std::isfinite(of(side).exact) &&
                origin(side) != no_node)
                return side;
        }
        return no_node;
    }

    /// The operation that made a value infinite or NaN: its own operands are finite.
    NodeId origin(NodeId i) {
        for (;;) {
            const TapeNode& n = tape_[i];
            if (is_given(n.op)) return no_node;
            const NodeId taken = side_taken(tape_, i);
            NodeId next = no_node;
            for (const NodeId operand : n.operands) {
                const bool follows = taken == no_node || operand == taken;
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
    Attribution found_;
    bool failed_ = false;
};

template <class Subject>
Attribution attributed(const Tape& tape, AttributionDepth depth, Subject subject) {
    if (!depth.full) {
        Walk<QuickExact> quick(tape, depth);
        if (!quick.failed()) quick.attribute(subject(quick));
        if (!quick.failed()) return quick.take();
    }
    Walk<DeepExact> deep(tape, depth);
    deep.attribute(subject(deep));
    return deep.take();
}

}  // namespace

bool is_plain_miss(const Tape& tape, const Attribution& found) {
    const NodeId hit = tape.outputs.hit;
    return hit != no_node && tape[hit].value == 0 && !found.exact_hit;
}

Attribution attribute(const Tape& tape, NodeId subject, AttributionDepth depth) {
    return attributed(tape, depth, [subject](auto&) { return subject; });
}

Attribution attribute(const Tape& tape, AttributionDepth depth) {
    Attribution found = attributed(tape, depth, [](auto& walk) { return walk.natural_subject(); });
    if (is_plain_miss(tape, found)) {
        found.culprit = no_node;
        found.equals.clear();
    }
    return found;
}

}  // namespace lostbits::measure::attribution
