#include "number/recorders/bounds_recorder.hpp"

namespace lostbits::number::recorders {

NodeId BoundsRecorder::input(double x, bool is_double) {
    return is_double || has_double_format_ ? add(Bounded<double>(x)) : add(Bounded<float>(x));
}

template <class F>
NodeId BoundsRecorder::compute(TapeOp op, const TapeOperands& operands) {
    const auto x = [&](NodeId i) { return bounded_number<F>(i); };
    const auto& [a, b, c] = operands;
    switch (op) {
        case TapeOp::add: return add(x(a) + x(b));
        case TapeOp::sub: return add(x(a) - x(b));
        case TapeOp::mul: return add(x(a) * x(b));
        case TapeOp::div: return add(x(a) / x(b));
        case TapeOp::sqrt: return add(sqrt(x(a)));
        case TapeOp::fma: return add(fma(x(a), x(b), x(c)));

        case TapeOp::neg: return add(-x(a));
        case TapeOp::abs: return add(abs(x(a)));
        case TapeOp::copysign: return add(copysign(x(a), x(b)));
        case TapeOp::min: return add(min(x(a), x(b)));
        case TapeOp::max: return add(max(x(a), x(b)));
        case TapeOp::select: return add(select(decision_mask(a), x(b), x(c)));
        case TapeOp::next_up: return add(next_up(x(a)));
        case TapeOp::next_down: return add(next_down(x(a)));

        case TapeOp::less: return add(x(a) < x(b));
        case TapeOp::less_equal: return add(x(a) <= x(b));
        case TapeOp::greater: return add(x(a) > x(b));
        case TapeOp::greater_equal: return add(x(a) >= x(b));

        case TapeOp::logical_and: return add(decision_mask(a) && decision_mask(b));
        case TapeOp::logical_or: return add(decision_mask(a) || decision_mask(b));
        case TapeOp::logical_not: return add(!decision_mask(a));
        case TapeOp::any: return a;

        case TapeOp::input:
        case TapeOp::constant:
        case TapeOp::call:
        case TapeOp::convert: break;  // have functions of their own
    }
    return a;
}

NodeId BoundsRecorder::apply(TapeOp op, const TapeOperands& operands) {
    const bool is_double = entry_of(op == TapeOp::select ? operands.b : operands.a).is_double;
    return is_double ? compute<double>(op, operands) : compute<float>(op, operands);
}

NodeId BoundsRecorder::convert(NodeId x, bool to_double) {
    if (entry_of(x).is_double == (to_double || has_double_format_)) return x;
    return to_double ? add(bounded_number<float>(x).template converted<double>())
                     : add(bounded_number<double>(x).template converted<float>());
}

NodeId BoundsRecorder::call(const Call& callee, std::span<const NodeId> arguments, double value, bool is_double) {
    const auto add_result = [&]<class F>() {
        std::vector<Bounded<F>> numbers;
        for (const NodeId a : arguments) numbers.push_back(bounded_number<F>(a));
        return add(call_result(callee, std::span<const Bounded<F>>(numbers), static_cast<F>(value)));
    };
    return is_double || has_double_format_ ? add_result.template operator()<double>()
                                           : add_result.template operator()<float>();
}

}  // namespace lostbits::number::recorders
