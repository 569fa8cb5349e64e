#include "measure/blame/operation_error.hpp"

#include <algorithm>
#include <cmath>

#include "number/error_free.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::blame {
namespace {

/// A fused operation on any doubles is exact in 3 · 1074 + 1024 bits and a few.
using Deep = BasicReal<4400>;

double rounding_reference(TapeOp op, const std::array<double, 3>& x, double value) {
    const Deep a(x[0]), b(x[1]), c(x[2]);
    Deep r;
    switch (op) {
        case TapeOp::add: r = a + b; break;
        case TapeOp::sub: r = a - b; break;
        case TapeOp::mul: r = a * b; break;
        case TapeOp::div: r = a / b; break;
        case TapeOp::sqrt: r = sqrt(a); break;
        default: r = a * b + c;
    }
    const double off = mpfr_get_d(Deep(Deep(value) - r).backend().data(), MPFR_RNDN);
    // Divisions and roots that are exact in the format are so here.
    return off;
}

/// value − (a + b), a + b = s + e.
double rounding_of_sum(double a, double b, double value) {
    const auto [s, e] = two_sum(a, b);
    return (value - s) - e;
}

double rounding_of_product(double a, double b, double value) {
    const auto [p, e] = two_product(a, b);
    return (value - p) - e;
}

/// a/b = q + r/b with r = a − qb exact.
double rounding_of_quotient(double a, double b, double value) {
    const double q = a / b;
    return (value - q) - quotient_residual(a, b, q) / b;
}

/// √a = s + r/(2s) to within (r/2s)²/2s, r = a − s².
double rounding_of_root(double a, double value) {
    const double s = std::sqrt(a);
    return (value - s) - root_residual(a, s) / (2 * s);
}

double rounding_of_finite(TapeOp op, const std::array<double, 3>& x, double value) {
    const auto [a, b, c] = x;
    switch (op) {
        case TapeOp::add:
        case TapeOp::sub:
            return std::fabs(a) <= error_free_high && std::fabs(b) <= error_free_high
                       ? rounding_of_sum(a, op == TapeOp::add ? b : -b, value)
                       : rounding_reference(op, x, value);
        case TapeOp::mul:
            return a == 0 || b == 0             ? 0
                   : residuals_are_exact(a * b) ? rounding_of_product(a, b, value)
                                                : rounding_reference(op, x, value);
        case TapeOp::div:
            return b == 0 || a == 0                   ? 0
                   : residuals_are_exact(a, b, a / b) ? rounding_of_quotient(a, b, value)
                                                      : rounding_reference(op, x, value);
        case TapeOp::sqrt:
            return a <= 0 ? 0 : residuals_are_exact(a) ? rounding_of_root(a, value) : rounding_reference(op, x, value);
        default: return rounding_reference(op, x, value);
    }
}

}  // namespace

NodeId first_side(const TapeNode& n) { return n.op == TapeOp::select ? n.operands[1] : n.operands[0]; }

NodeId other_side(const TapeNode& n, NodeId side) {
    const NodeId second = n.op == TapeOp::select ? n.operands[2] : n.operands[1];
    return side == first_side(n) ? second : first_side(n);
}

NodeId chosen(const Tape& tape, NodeId i) {
    const TapeNode& n = tape[i];
    const auto [a, b, c] = n.operands;
    switch (n.op) {
        case TapeOp::select: return tape[a].value != 0 ? b : c;
        case TapeOp::min: return tape[a].value < tape[b].value ? a : b;
        case TapeOp::max: return tape[a].value > tape[b].value ? a : b;
        default: return no_node;
    }
}

double rounding_of(const Tape& tape, NodeId i) {
    const TapeNode& n = tape[i];
    if (n.op == TapeOp::constant) return n.value - static_cast<double>(n.operands[0]);
    if (n.op == TapeOp::input || is_decision(n.op)) return 0;
    std::array<double, 3> x{};
    for (std::size_t k = 0; k < 3; ++k) {
        if (n.operands[k] == no_node || is_decision(tape[n.operands[k]].op)) continue;
        x[k] = tape[n.operands[k]].value;
        if (!std::isfinite(x[k])) return 0;
    }
    switch (n.op) {
        case TapeOp::next_up:
        case TapeOp::next_down:
        case TapeOp::convert: return n.value - x[0];
        case TapeOp::neg:
        case TapeOp::abs:
        case TapeOp::copysign:
        case TapeOp::min:
        case TapeOp::max:
        case TapeOp::select: return 0;
        default: break;
    }
    if (std::isnan(n.value) || (n.op == TapeOp::div && x[1] == 0)) return 0;
    return std::isinf(n.value) ? n.value : rounding_of_finite(n.op, x, n.value);
}

int cancellation(const Tape& tape, NodeId i) {
    const TapeNode& n = tape[i];
    if (n.op != TapeOp::add && n.op != TapeOp::sub && n.op != TapeOp::fma) return 0;
    double a = tape[n.operands[0]].value, b = tape[n.operands[1]].value;
    if (n.op == TapeOp::fma) {
        a *= b;
        b = tape[n.operands[2]].value;
    }
    const double largest = std::max(std::fabs(a), std::fabs(b));
    if (!std::isfinite(a) || !std::isfinite(b) || !std::isfinite(n.value) || largest == 0) return 0;
    if (n.value == 0) return tape.format_of(i).precision;
    return std::max(0, std::ilogb(largest) - std::ilogb(n.value));
}

double ulp_at(double x, const FloatFormat& format) {
    return std::ldexp(1.0,
                      static_cast<int>(ulp_exponent(format, x == 0 || !std::isfinite(x) ? -100000 : std::ilogb(x))));
}

double apply(TapeOp op, const std::array<double, 3>& x, const FloatFormat& f) {
    switch (op) {
        case TapeOp::add: return rounding::add(x[0], x[1], f);
        case TapeOp::sub: return rounding::add(x[0], -x[1], f);
        case TapeOp::mul: return rounding::mul(x[0], x[1], f);
        case TapeOp::div: return rounding::div(x[0], x[1], f);
        case TapeOp::sqrt: return rounding::sqrt(x[0], f);
        case TapeOp::fma: return rounding::fma(x[0], x[1], x[2], f);
        case TapeOp::neg: return -x[0];
        case TapeOp::abs: return std::fabs(x[0]);
        case TapeOp::copysign: return std::copysign(x[0], x[1]);
        case TapeOp::next_up: return rounding::next_up(x[0], f);
        case TapeOp::next_down: return -rounding::next_up(-x[0], f);
        default: return rounding::to_format(x[0], 0, f);
    }
}

Weights quotients(const TapeNode& n, const std::array<Operand, 3>& x, NodeId chosen, bool slopes) {
    const auto& [a, b, c] = x;
    // The operands between which a quotient is taken: the derivative is the quotient over no distance.
    const double a0 = slopes ? a.computed : a.exact, b0 = slopes ? b.computed : b.exact;
    const double a1 = a.computed, b1 = b.computed;
    const auto unsigned_by = [&] {  // (|a1| − |a0|)/(a1 − a0)
        if (std::signbit(a1) == std::signbit(a0)) return std::signbit(a1) ? -1.0 : 1.0;
        return (std::fabs(a1) - std::fabs(a0)) / (a1 - a0);
    };
    switch (n.op) {
        case TapeOp::add: return {{1, 1, 0}, {true, true, false}};
        case TapeOp::sub: return {{1, -1, 0}, {true, true, false}};
        case TapeOp::mul: return {{b0 / 2 + b1 / 2, a0 / 2 + a1 / 2, 0}, {true, true, false}};
        case TapeOp::fma: return {{b0 / 2 + b1 / 2, a0 / 2 + a1 / 2, 1}, {true, true, true}};
        case TapeOp::div: return {{(1 / b0 + 1 / b1) / 2, -(a0 / b0 / b1 + a1 / b0 / b1) / 2, 0}, {true, true, false}};
        case TapeOp::sqrt: {
            // Of a zero that is exact no error comes; its derivative is infinite all the same.
            const double sum = std::sqrt(a0) + std::sqrt(a1);
            return {{sum == 0 && !slopes ? 0 : 1 / sum, 0, 0}, {true, false, false}};
        }
        case TapeOp::neg: return {{-1, 0, 0}, {true, false, false}};
        case TapeOp::abs: return {{unsigned_by(), 0, 0}, {true, false, false}};
        case TapeOp::copysign: return {{std::signbit(b1) ? -unsigned_by() : unsigned_by(), 0, 0}, {true, false, false}};
        case TapeOp::next_up:
        case TapeOp::next_down:
        case TapeOp::convert: return {{1, 0, 0}, {true, false, false}};
        case TapeOp::min:
        case TapeOp::max:
        case TapeOp::select: {
            Weights w;
            for (std::size_t k = n.op == TapeOp::select ? 1 : 0; k < 3; ++k) {
                if (n.operands[k] != chosen || w.follows[0] || w.follows[1]) continue;
                w.by[k] = 1;
                w.follows[k] = true;
            }
            return w;
        }
        case TapeOp::less:
        case TapeOp::less_equal:
        case TapeOp::greater:
        case TapeOp::greater_equal: return {{1, -1, 0}, {true, true, false}};
        default: return {};
    }
}

}  // namespace lostbits::measure::blame
