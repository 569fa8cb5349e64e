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
    Tangents(const Tape& tape, NodeId input) : tape_(tape), of_(tape.nodes.size()) {
        of_[static_cast<std::size_t>(input)] = 1;
        for (NodeId i = input + 1; i < tape.size(); ++i) of_[static_cast<std::size_t>(i)] = of(i);
    }
    [[nodiscard]] double at(NodeId i) const { return of_[static_cast<std::size_t>(i)]; }

private:
    [[nodiscard]] double of(NodeId i) const {
        const TapeNode& n = tape_[i];
        const FloatFormat& f = tape_.format_of(i);
        const auto x = [&](std::size_t k) { return tape_[n.operands[k]].value; };
        const auto dx = [&](std::size_t k) { return at(n.operands[k]); };
        const auto product = [&] {
            return rounding::add(rounding::mul(dx(0), x(1), f), rounding::mul(x(0), dx(1), f), f);
        };
        switch (n.op) {
            case TapeOp::input:
            case TapeOp::constant: return 0;
            case TapeOp::add: return rounding::add(dx(0), dx(1), f);
            case TapeOp::sub: return rounding::add(dx(0), -dx(1), f);
            case TapeOp::mul: return product();
            case TapeOp::div: return rounding::div(rounding::add(dx(0), -rounding::mul(n.value, dx(1), f), f), x(1), f);
            case TapeOp::sqrt: return rounding::div(dx(0), rounding::add(n.value, n.value, f), f);
            case TapeOp::fma: return rounding::add(product(), dx(2), f);
            case TapeOp::neg: return -dx(0);
            case TapeOp::abs:
            case TapeOp::copysign: return std::signbit(n.value) == std::signbit(x(0)) ? dx(0) : -dx(0);
            case TapeOp::min:
            case TapeOp::max:
            case TapeOp::select: return at(attribution::side_taken(tape_, i));
            case TapeOp::next_up:
            case TapeOp::next_down: return dx(0);
            case TapeOp::convert: return rounding::to_format(dx(0), 0, f);
            case TapeOp::call: return std::numeric_limits<double>::quiet_NaN();
            default: return 0;  // decisions have none
        }
    }

    const Tape& tape_;
    std::vector<double> of_;
};

/// Calls `see(t)` for the first three crossings within a range, in order, until it returns true. True if it did.
template <class See>
bool any_crossing(const Ray<double>& ray, const Primitive<double>& primitive, Range<double> range, const See& see) {
    intersect::Convention every;
    every.inside = intersect::Inside::exit;
    for (int k = 0; k < 3 && range.holds_any(); ++k) {
        const truth::Truth found = truth::find_truth(ray, primitive, {}, every, range);
        if (!found.is_hit()) return false;
        const double at = truth::round_certified(found.t, binary64).value_or(found.t.hi);
        if (see(at)) return true;
        range = {.tmin = std::nextafter(at, HUGE_VAL)};
    }
    return false;
}

}  // namespace

std::vector<double> forward_derivatives(const Tape& tape) {
    std::vector<double> all;
    for (NodeId i = 0; i < tape.size(); ++i)
        if (tape[i].op == TapeOp::input) all.push_back(Tangents(tape, i).at(tape.outputs.t));
    return all;
}

bool is_wrong_root(const Ray<double>& ray, const Primitive<double>& primitive, const truth::Certified& truth,
                   double t) {
    const double meant = std::ldexp(truth.hi, static_cast<int>(truth.exponent));
    const auto is_at = [&](double other) { return std::fabs(t - other) <= std::fabs(other - meant) / 4; };
    // Just beyond the true t, by more than the rounding of a truth to double can move it.
    const double beyond = meant * (1 + 0x1p-50);
    if (any_crossing(ray, primitive, {.tmin = beyond, .open = {.tmin = true}}, is_at)) return true;
    const Ray<double> back{ray.origin, -ray.direction};
    return any_crossing(back, primitive, {}, [&](double other) { return other != meant && is_at(-other); });
}

}  // namespace lostbits::measure::stability
