#include "number/recorders/tape_recorder.hpp"

namespace lostbits::number::recorders {

namespace {

/// Computes an operation on numbers of T, or a decision (1 or 0) about numbers or decisions, from the values of its
/// operands.
template <class T, class ToNumber, class ToValue>
double compute(TapeOp op, double x, double y, double z, const ToNumber& to_number, const ToValue& to_value) {
    const T a = to_number(x), b = to_number(y), c = to_number(z);
    switch (op) {
        case TapeOp::add: return to_value(a + b);
        case TapeOp::sub: return to_value(a - b);
        case TapeOp::mul: return to_value(a * b);
        case TapeOp::div: return to_value(a / b);
        case TapeOp::sqrt: return to_value(sqrt(a));
        case TapeOp::fma: return to_value(fma(a, b, c));

        case TapeOp::neg: return -x;
        case TapeOp::abs: return abs(x);
        case TapeOp::copysign: return copysign(x, y);
        case TapeOp::min: return x < y ? x : y;
        case TapeOp::max: return x > y ? x : y;
        case TapeOp::select: return x != 0 ? y : z;
        case TapeOp::next_up: return to_value(next_up(a));
        case TapeOp::next_down: return to_value(next_down(a));

        case TapeOp::less: return x < y;
        case TapeOp::less_equal: return x <= y;
        case TapeOp::greater: return x > y;
        case TapeOp::greater_equal: return x >= y;

        case TapeOp::logical_and: return x != 0 && y != 0;
        case TapeOp::logical_or: return x != 0 || y != 0;
        case TapeOp::logical_not: return x == 0;
        case TapeOp::any: return x;

        case TapeOp::input:
        case TapeOp::constant:
        case TapeOp::call:
        case TapeOp::convert: break;  // have functions of their own
    }
    return x;
}

double compute_in(const FloatFormat& format, TapeOp op, double x, double y, double z) {
    const auto to_float = [](double v) { return static_cast<float>(v); };
    const auto widen = [](auto v) { return static_cast<double>(v); };
    if (format == binary32) return compute<float>(op, x, y, z, to_float, widen);
    if (format == binary64) return compute<double>(op, x, y, z, widen, widen);
    return compute<RoundedAny>(op, x, y, z, RoundedAny::from_value, [](RoundedAny v) { return v.value(); });
}

}  // namespace

NodeId TapeRecorder::constant(int x, bool is_double) {
    const FloatFormat& format = format_of(is_double);
    const double value = is_double ? x : RoundedAny(x).value();
    return tape_.add(TapeOp::constant, format, value, {x});
}

NodeId TapeRecorder::input(double x, bool is_double) {
    return tape_.add_input(format_of(is_double), is_double ? x : RoundedAny(x).value());
}

NodeId TapeRecorder::apply(TapeOp op, const TapeOperands& operands) {
    const auto value = [this](NodeId i) { return i == no_node ? 0.0 : tape_[i].value; };
    const FloatFormat operand_format = tape_.format_of(op == TapeOp::select ? operands.b : operands.a);
    const FloatFormat& result_format = is_decision(op) ? tape_.formats.front() : operand_format;
    return tape_.add(op, result_format,
                     compute_in(operand_format, op, value(operands.a), value(operands.b), value(operands.c)), operands);
}

NodeId TapeRecorder::convert(NodeId x, bool to_double) {
    const FloatFormat& target_format = format_of(to_double);
    if (tape_.format_of(x) == target_format) return x;
    return tape_.add(TapeOp::convert, target_format, to_double ? tape_[x].value : RoundedAny(tape_[x].value).value(),
                     {x});
}

NodeId TapeRecorder::call(const Call& callee, std::span<const NodeId> arguments, double value, bool is_double) {
    return tape_.add_call(callee, format_of(is_double), value, {arguments.begin(), arguments.end()});
}

}  // namespace lostbits::number::recorders
