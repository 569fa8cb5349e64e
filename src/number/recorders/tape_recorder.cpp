#include "number/recorders/tape_recorder.hpp"

namespace lostbits::number::recorders {

namespace {

/// An operation on numbers of T, or a decision about them or about decisions (1 or 0), by the values of its operands.
template <class T, class Lift, class Drop>
double computed(TapeOp op, double x, double y, double z, const Lift& lift, const Drop& drop) {
    const T a = lift(x), b = lift(y), c = lift(z);
    switch (op) {
        case TapeOp::add: return drop(a + b);
        case TapeOp::sub: return drop(a - b);
        case TapeOp::mul: return drop(a * b);
        case TapeOp::div: return drop(a / b);
        case TapeOp::sqrt: return drop(sqrt(a));
        case TapeOp::fma: return drop(fma(a, b, c));
        case TapeOp::neg: return -x;
        case TapeOp::abs: return abs(x);
        case TapeOp::copysign: return copysign(x, y);
        case TapeOp::min: return x < y ? x : y;
        case TapeOp::max: return x > y ? x : y;
        case TapeOp::select: return x != 0 ? y : z;
        case TapeOp::next_up: return drop(next_up(a));
        case TapeOp::next_down: return drop(next_down(a));
        case TapeOp::less: return x < y;
        case TapeOp::less_equal: return x <= y;
        case TapeOp::greater: return x > y;
        case TapeOp::greater_equal: return x >= y;
        case TapeOp::both: return x != 0 && y != 0;
        case TapeOp::either: return x != 0 || y != 0;
        case TapeOp::opposite: return x == 0;
        case TapeOp::any: return x;
        case TapeOp::input:
        case TapeOp::constant:
        case TapeOp::call:
        case TapeOp::convert: break;  // functions of their own
    }
    return x;
}

double computed_in(const FloatFormat& format, TapeOp op, double x, double y, double z) {
    const auto lift_float = [](double v) { return static_cast<float>(v); };
    const auto same = [](auto v) { return static_cast<double>(v); };
    if (format == binary32) return computed<float>(op, x, y, z, lift_float, same);
    if (format == binary64) return computed<double>(op, x, y, z, same, same);
    return computed<RoundedAny>(op, x, y, z, RoundedAny::holding, [](RoundedAny v) { return v.value(); });
}

}  // namespace

NodeId TapeRecorder::constant(int x, bool in_double) {
    const FloatFormat& format = format_of(in_double);
    const double value = in_double ? x : RoundedAny(x).value();
    return tape_.add(TapeOp::constant, format, value, {x});
}

NodeId TapeRecorder::input(double x, bool in_double) {
    return tape_.add_input(format_of(in_double), in_double ? x : RoundedAny(x).value());
}

NodeId TapeRecorder::apply(TapeOp op, const TapeOperands& of) {
    const auto value = [this](NodeId i) { return i == no_node ? 0.0 : tape_[i].value; };
    const FloatFormat format = tape_.format_of(op == TapeOp::select ? of.b : of.a);
    const FloatFormat& noted = is_decision(op) ? tape_.formats.front() : format;
    return tape_.add(op, noted, computed_in(format, op, value(of.a), value(of.b), value(of.c)), of);
}

NodeId TapeRecorder::convert(NodeId x, bool to_double) {
    const FloatFormat& to = format_of(to_double);
    if (tape_.format_of(x) == to) return x;
    return tape_.add(TapeOp::convert, to, to_double ? tape_[x].value : RoundedAny(tape_[x].value).value(), {x});
}

NodeId TapeRecorder::call(const Call& of, std::span<const NodeId> arguments, double value, bool in_double) {
    return tape_.add_call(of, format_of(in_double), value, {arguments.begin(), arguments.end()});
}

}  // namespace lostbits::number::recorders
