#include "measure/blame/attribution.hpp"

#include <algorithm>
#include <cmath>

#include "measure/blame/operation_error.hpp"
#include "measure/blame/shadow.hpp"
#include "measure/metric/metrics.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::blame {
namespace {

/// One tape over one kind of exact number: forward for the exact values, backward for the adjoints.
template <class Shadow>
class Walk {
public:
    using S = typename Shadow::Number;

    Walk(const Tape& tape, AttributionDepth depth) : tape_(tape), depth_(depth), exact_(tape.nodes.size(), S(0)) {
        found_.of.resize(tape.nodes.size());
        found_.shadow_bits = Shadow::bits;
        for (NodeId i = 0; i < tape.size(); ++i) forward(i);
        found_.exact_hit = tape.outputs.hit != no_node && is_true(tape.outputs.hit);
    }

    [[nodiscard]] bool failed() const { return failed_; }
    [[nodiscard]] Attribution take() { return std::move(found_); }

    /// The form's t, where its decision stands without rounding too.
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
    }

private:
    OperationError& of(NodeId i) { return found_.of[static_cast<std::size_t>(i)]; }
    S& exact(NodeId i) { return exact_[static_cast<std::size_t>(i)]; }
    [[nodiscard]] double computed(NodeId i) const { return tape_[i].value; }
    bool is_true(NodeId i) { return of(i).exact != 0; }

    bool settled(const std::optional<bool>& decision, bool as_computed) {
        failed_ |= !decision.has_value();
        return decision.value_or(as_computed);
    }
    bool exactly_less(NodeId a, NodeId b, bool as_computed) {
        return settled(Shadow::less(exact(a), exact(b)), as_computed);
    }
    bool exactly_less_equal(NodeId a, NodeId b, bool as_computed) {
        return settled(Shadow::less_equal(exact(a), exact(b)), as_computed);
    }

    void forward(NodeId i) {
        const TapeNode& n = tape_[i];
        const auto [a, b, c] = n.operands;
        OperationError& e = of(i);
        if (is_decision(n.op)) return decide(i);
        switch (n.op) {
            case TapeOp::input: exact(i) = Shadow::lift(n.value); break;
            case TapeOp::constant: exact(i) = S(static_cast<int>(a)); break;
            case TapeOp::add: exact(i) = Shadow::sum(exact(a), exact(b)); break;
            case TapeOp::sub: exact(i) = Shadow::sum(exact(a), -exact(b)); break;
            case TapeOp::mul: exact(i) = exact(a) * exact(b); break;
            case TapeOp::div: exact(i) = exact(a) / exact(b); break;
            case TapeOp::sqrt: exact(i) = sqrt(exact(a)); break;
            case TapeOp::fma: exact(i) = Shadow::sum(exact(a) * exact(b), exact(c)); break;
            case TapeOp::neg: exact(i) = -exact(a); break;
            case TapeOp::next_up:
            case TapeOp::next_down:
            case TapeOp::convert: exact(i) = exact(a); break;
            case TapeOp::abs: exact(i) = abs(exact(a)); break;
            case TapeOp::copysign: sign(i); break;
            default: choose(i);
        }
        if (n.op == TapeOp::input) {
            e.exact = n.value;  // infinity too, which a ball holds no better than as a large number
            return;
        }
        e.exact = Shadow::nearest(exact(i));
        e.error = Shadow::difference(n.value, exact(i));
        if (!e.turned) e.rounding = rounding_of(tape_, i);
        e.cancelled = cancellation(tape_, i);
        for (const NodeId operand : n.operands)
            e.carried |= n.op != TapeOp::constant && operand != no_node && of(operand).error != 0;
        if (depth_.full) e.local_bits = local_bits(i);
    }

    void decide(NodeId i) {
        const TapeNode& n = tape_[i];
        const auto [a, b, c] = n.operands;
        const bool was = n.value != 0;
        bool is = was;
        switch (n.op) {
            case TapeOp::less: is = exactly_less(a, b, was); break;
            case TapeOp::less_equal: is = exactly_less_equal(a, b, was); break;
            case TapeOp::greater: is = exactly_less(b, a, was); break;
            case TapeOp::greater_equal: is = exactly_less_equal(b, a, was); break;
            case TapeOp::both: is = is_true(a) && is_true(b); break;
            case TapeOp::either: is = is_true(a) || is_true(b); break;
            case TapeOp::opposite: is = !is_true(a); break;
            default: is = is_true(a);
        }
        of(i).exact = is;
        of(i).turned = is != was;
        if (n.op == TapeOp::any && is && !was) found_.cut_short = true;
    }

    /// select, min, max: the exact value is that of the side that exact values choose; where it is not the side that
    /// was taken, what lies between the two is the choice's own error.
    void choose(NodeId i) {
        const NodeId taken = chosen(tape_, i);
        const TapeNode& n = tape_[i];
        const bool first = taken == first_side(n);
        bool exactly = first;
        if (n.op == TapeOp::select) exactly = is_true(n.operands[0]);
        else if (n.operands[0] != n.operands[1])
            exactly = n.op == TapeOp::min ? exactly_less(n.operands[0], n.operands[1], first)
                                          : exactly_less(n.operands[1], n.operands[0], first);
        const NodeId meant = exactly == first ? taken : other_side(n, taken);
        exact(i) = exact(meant);
        of(i).turned = meant != taken;
        if (meant == taken) return;
        of(i).rounding =
            is_cut(taken) ? Shadow::difference(n.value, exact(meant)) : Shadow::nearest(exact(taken) - exact(meant));
    }

    /// Whether a side that was taken by mistake has no exact value (the root of what is negative but for rounding):
    /// then the whole error is the choice's, and none comes from that side.
    bool is_cut(NodeId taken) { return !std::isfinite(of(taken).exact) && tape_[taken].op != TapeOp::input; }

    /// |a| with the sign of b; of a zero or NaN the sign as computed.
    void sign(NodeId i) {
        const auto [a, b, c] = tape_[i].operands;
        const double by = Shadow::nearest(exact(b));
        const bool was = std::signbit(computed(b));
        bool negative = was;
        if (by != 0 && !std::isnan(by)) negative = settled(Shadow::less(exact(b), S(0)), was);
        const S size = abs(exact(a));
        exact(i) = negative ? -size : size;
        of(i).turned = negative != was;
        if (negative != was) of(i).rounding = Shadow::nearest(was ? -size - size : size + size);
    }

    double local_bits(NodeId i) {
        if constexpr (std::same_as<Shadow, DeepShadow>) {
            const TapeNode& n = tape_[i];
            if (!is_operation(n.op) || n.op >= TapeOp::min || n.op == TapeOp::neg)
                return n.op == TapeOp::convert ? bits_off(i, round_to(exact(n.operands[0]), i), i) : 0;
            std::array<double, 3> x{};
            for (std::size_t k = 0; k < 3; ++k) {
                if (n.operands[k] != no_node) x[k] = round_to(exact(n.operands[k]), n.operands[k]);
            }
            return bits_off(i, apply(n.op, x, tape_.format_of(i)), i);
        }
        return 0;
    }
    double round_to(const S& x, NodeId as) {
        const double near = Shadow::nearest(x);
        const double rest = Shadow::nearest(x - S(near));
        return rounding::to_format(near, (rest > 0) - (rest < 0), tape_.format_of(as));
    }
    double bits_off(NodeId i, double rerun, NodeId as) {
        const double off = Shadow::difference(rerun, exact(i));
        if (!std::isfinite(off) || off == 0) return 0;
        const double size = std::fabs(of(i).exact);
        const long e = ulp_exponent(tape_.format_of(as), size == 0 ? -100000 : std::ilogb(size));
        return metric::lost_bits(std::ldexp(off, static_cast<int>(-e)), tape_.format_of(as).precision);
    }

    void seed(NodeId subject) {
        OperationError& e = of(subject);
        e.live = true;
        e.adjoint = e.derivative = 1;
    }

    /// Hands node i's adjoint on to its operands. A comparison stands for the difference of its sides.
    void backward(NodeId i) {
        const TapeNode& n = tape_[i];
        const OperationError& e = of(i);
        if (!e.live || n.op == TapeOp::input || n.op == TapeOp::constant) return;
        failed_ |= !is_decision(n.op) && !Shadow::is_good(exact(i), n.value);
        if (const NodeId taken = chosen(tape_, i); e.turned && taken != no_node && is_cut(taken)) return;
        std::array<Operand, 3> x{};
        for (std::size_t k = 0; k < 3; ++k) {
            if (n.operands[k] != no_node && !is_decision(tape_[n.operands[k]].op))
                x[k] = {computed(n.operands[k]), of(n.operands[k]).exact};
        }
        const Weights difference = quotients(n, x, chosen(tape_, i), false);
        const Weights slope = depth_.full ? quotients(n, x, chosen(tape_, i), true) : Weights{};
        for (std::size_t k = 0; k < 3; ++k) {
            if (!difference.follows[k]) continue;
            OperationError& operand = of(n.operands[k]);
            operand.live = true;
            operand.adjoint += e.adjoint * difference.by[k];
            if (depth_.full) operand.derivative += e.derivative * slope.by[k];
        }
    }

    void sum_up(NodeId i) {
        OperationError& e = of(i);
        if (!e.live || e.rounding == 0) return;
        e.contribution = e.rounding * e.adjoint;
        found_.explained += e.contribution;
        if (depth_.full) found_.first_order += e.rounding * e.derivative;
        if (found_.culprit == no_node || std::fabs(e.contribution) > std::fabs(of(found_.culprit).contribution))
            found_.culprit = i;
    }

    /// (computed left − right) − (exact left − right) of a comparison.
    double apart(NodeId comparison) {
        const auto [a, b, c] = tape_[comparison].operands;
        return of(a).error - of(b).error;
    }

    /// The first comparison, in the order of the formula, that made a decision other than exact values make it.
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

    /// The subject where it is not finite; of a comparison, the side that is not finite and would be without
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

    /// The operation that made a value infinite or NaN: its own operands are still finite.
    NodeId origin(NodeId i) {
        for (;;) {
            const TapeNode& n = tape_[i];
            if (n.op == TapeOp::input || n.op == TapeOp::constant) return no_node;
            NodeId next = no_node;
            for (const NodeId operand : n.operands) {
                const bool taken = chosen(tape_, i) == no_node || operand == chosen(tape_, i);
                if (operand != no_node && taken && next == no_node && !std::isfinite(computed(operand))) next = operand;
            }
            if (next == no_node) return i;
            i = next;
        }
    }

    const Tape& tape_;
    AttributionDepth depth_;
    std::vector<S> exact_;
    Attribution found_;
    bool failed_ = false;
};

template <class Subject>
Attribution attributed(const Tape& tape, AttributionDepth depth, Subject subject) {
    if (!depth.full) {
        Walk<QuickShadow> quick(tape, depth);
        if (!quick.failed()) quick.attribute(subject(quick));
        if (!quick.failed()) return quick.take();
    }
    Walk<DeepShadow> deep(tape, depth);
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
    if (is_plain_miss(tape, found)) found.culprit = no_node;
    return found;
}

}  // namespace lostbits::measure::blame
