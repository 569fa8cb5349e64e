// Arithmetic for the exact values of a tape, in numbers that do not round or that bound their rounding error.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "measure/answer/without_rounding.hpp"
#include "number/ball.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::attribution {

/// Double-double with bounds: fast enough for a map.
struct QuickExact {
    using Number = Ball;
    static constexpr int bits = 106;

    /// An infinity becomes a number that is larger than every finite one.
    static Ball sum(const Ball& a, const Ball& b) { return a + b; }
    static Ball lift(double x) { return std::isinf(x) ? Ball(std::copysign(0x1p+880, x)) : Ball(x); }
    static std::optional<bool> less(const Ball& a, const Ball& b) { return to_optional(a < b); }
    static std::optional<bool> less_equal(const Ball& a, const Ball& b) { return to_optional(a <= b); }
    static double nearest(const Ball& x) { return x.undefined() == Undefined::always ? std::nan("") : x.hi(); }
    /// Returns computed − exact; zero if the bound leaves open whether they differ.
    static double difference(double computed, const Ball& exact) {
        const Ball d = lift(computed) - exact;
        return std::fabs(d.hi()) <= d.radius() ? 0 : d.hi() + d.lo();
    }
    static bool is_accurate_enough(const Ball& x, double computed) {
        return std::isfinite(computed) && x.is_bounded() &&
               x.radius() <= 0x1p-60 * std::fmax(std::fabs(computed), std::fabs(x.hi()));
    }

private:
    static std::optional<bool> to_optional(Tri t) { return t.is_unknown() ? std::nullopt : std::optional(t.is_yes()); }
};

/// Numbers of 2048 bits: exact for the sums and products of a form, except on rays that span thousands of binades, and
/// nearly exact for its roots.
struct DeepExact {
    using Number = BasicReal<2048>;
    static constexpr int bits = 2048;

    /// Factors and roots that are equal may differ by their rounding. So a sum below 2^-1900 of its parts becomes
    /// zero. Otherwise the sign of an offset that is zero (h of a foot point, dot(p, d)) would be the sign of noise.
    static Number sum(const Number& a, const Number& b) {
        const Number s = a + b;
        const bool are_regular =
            mpfr_regular_p(a.backend().data()) != 0 && mpfr_regular_p(b.backend().data()) != 0 && s != 0;
        return are_regular && ilogb(s) < std::max(ilogb(a), ilogb(b)) - 1900 ? Number(0) : s;
    }
    static Number lift(double x) { return Number(x); }
    static std::optional<bool> less(const Number& a, const Number& b) { return a < b && !are_equal(a, b); }
    static std::optional<bool> less_equal(const Number& a, const Number& b) { return a <= b || are_equal(a, b); }
    static double nearest(const Number& x) { return mpfr_get_d(x.backend().data(), MPFR_RNDN); }
    static double difference(double computed, const Number& exact) { return nearest(Number(computed) - exact); }
    /// Rounds to the nearest number of the format, as if in one step.
    static double round_to(const Number& x, const FloatFormat& format) {
        const double nearest_double = nearest(x), low_part = nearest(x - Number(nearest_double));
        return rounding::to_format(nearest_double, (low_part > 0) - (low_part < 0), format);
    }
    static bool is_accurate_enough(const Number& /*x*/, double /*computed*/) { return true; }

private:
    static bool are_equal(const Number& a, const Number& b) { return sum(a, -b) == 0; }
};

/// Result of a call on a tape without rounding; `value(operand)` are its arguments.
template <class Exact, class Value>
std::optional<typename Exact::Number> result_of_call(const Tape& tape, NodeId call, const Value& value) {
    std::vector<typename Exact::Number> arguments;
    for (const NodeId operand : tape.operands_of(call)) arguments.push_back(value(operand));
    return answer::evaluate_exactly(tape.call_at(call).callee, std::span<const typename Exact::Number>(arguments));
}

/// Factors by which errors of the arguments pass through a call. The arguments move from their exact to their computed
/// values one after the other, so the quotients leave no remainder. For an argument that is exact, the quotient is the
/// derivative.
struct CallSlopes {
    using Number = DeepExact::Number;
    std::vector<double> quotients, derivatives;

    CallSlopes(const Call& call, std::vector<Number> arguments, const std::vector<Number>& computed) {
        for (std::size_t k = 0; k < arguments.size(); ++k) {
            const Number& x = computed[k];
            derivatives.push_back(quotient(call, computed, k, x == 0 ? Number(0x1p-600) : Number(x * near_one)));
            quotients.push_back(arguments[k] == x ? derivatives.back() : quotient(call, arguments, k, x));
            arguments[k] = x;
        }
    }

private:
    /// A step so short that its second-order term vanishes in a double.
    static inline const Number near_one = Number(1) + ldexp(Number(1), -600);

    static double quotient(const Call& call, std::vector<Number> arguments, std::size_t k, const Number& end) {
        const auto value_before = answer::evaluate_exactly(call, std::span<const Number>(arguments));
        const Number step = end - arguments[k];
        arguments[k] = end;
        const auto value_after = answer::evaluate_exactly(call, std::span<const Number>(arguments));
        const double q =
            value_before && value_after && step != 0 ? DeepExact::nearest((*value_after - *value_before) / step) : 0;
        return std::isfinite(q) ? q : 0;
    }
};

}  // namespace lostbits::measure::attribution
