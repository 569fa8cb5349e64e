#include "number/recorders/bounds_recorder.hpp"

namespace lostbits::number::recorders {

NodeId BoundsRecorder::input(double x, bool in_double) {
    return in_double || is_double_ ? add(Bounded<double>(x)) : add(Bounded<float>(x));
}

template <class F>
NodeId BoundsRecorder::computed(TapeOp op, const TapeOperands& of) {
    const auto x = [&](NodeId i) { return number<F>(i); };
    const auto& [a, b, c] = of;
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
        case TapeOp::select: return add(select(decision(a), x(b), x(c)));
        case TapeOp::next_up: return add(next_up(x(a)));
        case TapeOp::next_down: return add(next_down(x(a)));
        case TapeOp::less: return add(x(a) < x(b));
        case TapeOp::less_equal: return add(x(a) <= x(b));
        case TapeOp::greater: return add(x(a) > x(b));
        case TapeOp::greater_equal: return add(x(a) >= x(b));
        case TapeOp::both: return add(decision(a) && decision(b));
        case TapeOp::either: return add(decision(a) || decision(b));
        case TapeOp::opposite: return add(!decision(a));
        case TapeOp::any: return a;
        case TapeOp::input:
        case TapeOp::constant:
        case TapeOp::call:
        case TapeOp::convert: break;  // functions of their own
    }
    return a;
}

NodeId BoundsRecorder::apply(TapeOp op, const TapeOperands& of) {
    const bool in_double = at(op == TapeOp::select ? of.b : of.a).in_double;
    return in_double ? computed<double>(op, of) : computed<float>(op, of);
}

NodeId BoundsRecorder::convert(NodeId x, bool to_double) {
    if (at(x).in_double == (to_double || is_double_)) return x;
    return to_double ? add(number<float>(x).template converted<double>())
                     : add(number<double>(x).template converted<float>());
}

NodeId BoundsRecorder::call(const Call& of, std::span<const NodeId> arguments, double value, bool in_double) {
    const auto known = [&]<class F>() {
        std::vector<Bounded<F>> numbers;
        for (const NodeId a : arguments) numbers.push_back(number<F>(a));
        return add(called(of, std::span<const Bounded<F>>(numbers), static_cast<F>(value)));
    };
    return in_double || is_double_ ? known.template operator()<double>() : known.template operator()<float>();
}

}  // namespace lostbits::number::recorders
