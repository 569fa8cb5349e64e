#include "measure/stability/stability.hpp"

#include <cmath>
#include <limits>

#include "measure/attribution/operation_error.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::stability {

namespace {

/// Derivatives of all nodes by one input, each rounded to the format of its node.
class Tangents {
public:
    Tangents(const Tape& tape, NodeId input) : tape_(tape), derivatives_(tape.nodes.size()) {
        derivatives_[input] = 1;
        for (NodeId i = input + 1; i < tape.size(); ++i) derivatives_[i] = derivative_of(i);
    }
    [[nodiscard]] double at(NodeId i) const { return derivatives_[i]; }

private:
    [[nodiscard]] double derivative_of(NodeId i) const {
        const TapeNode& node = tape_[i];
        const FloatFormat& format = tape_.format_of(i);
        const auto x = [&](std::size_t k) { return tape_[node.operands[k]].value; };
        const auto dx = [&](std::size_t k) { return at(node.operands[k]); };
        const auto product = [&] {
            return rounding::add(rounding::mul(dx(0), x(1), format), rounding::mul(x(0), dx(1), format), format);
        };
        switch (node.op) {
            // Numbers that do not depend on the input
            case TapeOp::input:
            case TapeOp::constant: return 0;

            // Operations that round
            case TapeOp::add: return rounding::add(dx(0), dx(1), format);
            case TapeOp::sub: return rounding::add(dx(0), -dx(1), format);
            case TapeOp::mul: return product();
            case TapeOp::div:
                return rounding::div(rounding::add(dx(0), -rounding::mul(node.value, dx(1), format), format), x(1),
                                     format);
            case TapeOp::sqrt: return rounding::div(dx(0), rounding::add(node.value, node.value, format), format);
            case TapeOp::fma: return rounding::add(product(), dx(2), format);
            case TapeOp::convert: return rounding::to_format(dx(0), 0, format);

            // Operations whose result is an operand, or has its size
            case TapeOp::neg: return -dx(0);
            case TapeOp::abs:
            case TapeOp::copysign: return std::signbit(node.value) == std::signbit(x(0)) ? dx(0) : -dx(0);
            case TapeOp::min:
            case TapeOp::max:
            case TapeOp::select: return at(attribution::chosen_side(tape_, i));
            case TapeOp::next_up:
            case TapeOp::next_down: return dx(0);

            case TapeOp::call: return std::numeric_limits<double>::quiet_NaN();
            default: return 0;  // decisions have no derivative
        }
    }

    const Tape& tape_;
    std::vector<double> derivatives_;
};

/// Calls `is_match(t)` for the first three crossings within a range, in order, until it returns true. Returns true if
/// it did.
template <class IsMatch>
bool any_crossing(const Ray<double>& ray, const Primitive<double>& primitive, Range<double> range,
                  const IsMatch& is_match) {
    intersect::Convention convention;
    convention.inside = intersect::Inside::exit;
    for (int k = 0; k < 3 && range.holds_any(); ++k) {
        const truth::Truth crossing = truth::find_truth(ray, primitive, {}, convention, range);
        if (!crossing.is_hit()) return false;
        const double t = truth::round_certified(crossing.t, binary64).value_or(crossing.t.hi);
        if (is_match(t)) return true;
        range = {.tmin = std::nextafter(t, HUGE_VAL)};
    }
    return false;
}

}  // namespace

std::vector<double> compute_forward_derivatives(const Tape& tape) {
    std::vector<double> derivatives;
    for (NodeId i = 0; i < tape.size(); ++i)
        if (tape[i].op == TapeOp::input) derivatives.push_back(Tangents(tape, i).at(tape.outputs.t));
    return derivatives;
}

bool is_wrong_root(const Ray<double>& ray, const Primitive<double>& primitive, const truth::CertifiedNumber& truth,
                   double t) {
    const double true_t = std::ldexp(truth.hi, static_cast<int>(truth.exponent));
    const auto is_near = [&](double other) { return std::fabs(t - other) <= std::fabs(other - true_t) / 4; };
    // Just beyond the true t, by more than the rounding of a truth to double can move it.
    const double after_true_t = true_t * (1 + 0x1p-50);
    if (any_crossing(ray, primitive, {.tmin = after_true_t, .open_ends = {.tmin = true}}, is_near)) return true;
    const Ray<double> backward_ray{ray.origin, -ray.direction};
    return any_crossing(backward_ray, primitive, {}, [&](double other) { return other != true_t && is_near(-other); });
}

}  // namespace lostbits::measure::stability
