#include "measure/attribution/operation_error.hpp"

#include <algorithm>
#include <cmath>

#include "measure/attribution/exact_arithmetic.hpp"
#include "measure/attribution/operations.hpp"
#include "number/real.hpp"

namespace lostbits::measure::attribution {
namespace {

/// Arithmetic that is exact for a fused operation on any doubles: 3 · 1074 + 1024 bits and a few more.
struct ResidualExact {
    using Number = BasicReal<4400>;
    static Number sum(const Number& a, const Number& b) { return a + b; }
};

/// Decides by computed values, as the format did.
struct ComputedDecider {
    const Tape& tape;
    const TapeNode& n;
    [[nodiscard]] double value(std::size_t k) const { return tape[n.operands[k]].value; }
    [[nodiscard]] bool less(std::size_t a, std::size_t b) const { return value(a) < value(b); }
    [[nodiscard]] bool holds(std::size_t k) const { return value(k) != 0; }
};

/// Rounding error for finite operands and a result that is not NaN.
template <TapeOp op>
double rounding_from(const std::array<double, 3>& x, double value) {
    using Deep = ResidualExact::Number;
    const auto operand = [&](std::size_t k) { return x[k]; };
    if (std::isfinite(value)) {
        const auto residual = [value](auto... operands) { return Operation<op>::residual(operands..., value); };
        if (const auto error = with_operands<op>(residual, operand)) return *error;
    }
    const Deep exact =
        with_operands<op>([](auto... operands) -> Deep { return Operation<op>::exact(ResidualExact(), operands...); },
                          [&](std::size_t k) { return Deep(x[k]); });
    if (std::isinf(value)) return mpfr_number_p(exact.backend().data()) != 0 ? value : 0;  // a/0 is not an overflow
    return mpfr_get_d(Deep(Deep(value) - exact).backend().data(), MPFR_RNDN);
}

}  // namespace

NodeId chosen_side(const Tape& tape, NodeId i) {
    const TapeNode& n = tape[i];
    return kind_of(n.op) == OperationKind::choice ? chosen_side(n, ComputedDecider{tape, n}) : no_node;
}

bool can_err(TapeOp op) {
    switch (kind_of(op)) {
        case OperationKind::given: return op == TapeOp::constant;
        case OperationKind::rounded:
        case OperationKind::called:
        case OperationKind::next_or_converted:
        case OperationKind::sign:
        case OperationKind::choice: return true;
        case OperationKind::exact:
        case OperationKind::comparison:
        case OperationKind::logic: return false;
    }
    return false;
}

double rounding_of(const Tape& tape, NodeId i) {
    const TapeNode& n = tape[i];
    if (is_given(n.op)) {
        return visit_operation<OperationKind::given>(n.op, [&]<TapeOp op>() { return Operation<op>::rounding(n); });
    }

    // Only finite operands and results have a rounding error.
    if (std::isnan(n.value)) return 0;
    std::array<double, 3> x{};
    for (std::size_t k = 0; k < row_of(n.op).operand_count; ++k) {
        x[k] = tape[n.operands[k]].value;
        if (!std::isfinite(x[k])) return 0;
    }

    switch (kind_of(n.op)) {
        case OperationKind::rounded:
            return visit_operation<OperationKind::rounded>(n.op,
                                                           [&]<TapeOp op>() { return rounding_from<op>(x, n.value); });
        case OperationKind::next_or_converted: return n.value - x[0];
        case OperationKind::called: {
            const auto exact = result_of_call<DeepExact>(
                tape, i, [&](NodeId operand) { return DeepExact::lift(tape[operand].value); });
            return exact ? DeepExact::difference(n.value, *exact) : 0;
        }
        case OperationKind::given:
        case OperationKind::exact:
        case OperationKind::sign:
        case OperationKind::choice:
        case OperationKind::comparison:
        case OperationKind::logic: return 0;
    }
    return 0;
}

int cancellation(const Tape& tape, NodeId i) {
    const TapeNode& n = tape[i];
    if (kind_of(n.op) != OperationKind::rounded) return 0;
    const Addends addends = visit_operation<OperationKind::rounded>(n.op, [&]<TapeOp op>() {
        return with_operands<op>([](auto... x) { return Operation<op>::addends(x...); },
                                 [&](std::size_t k) { return tape[n.operands[k]].value; });
    });
    if (!addends) return 0;
    const auto [a, b] = *addends;
    const double largest = std::max(std::fabs(a), std::fabs(b));
    if (!std::isfinite(a) || !std::isfinite(b) || !std::isfinite(n.value) || largest == 0) return 0;
    if (n.value == 0) return tape.format_of(i).precision;
    return std::max(0, std::ilogb(largest) - std::ilogb(n.value));
}

double ulp_at(double x, const FloatFormat& format) {
    return std::ldexp(1.0,
                      static_cast<int>(ulp_exponent(format, x == 0 || !std::isfinite(x) ? -100000 : std::ilogb(x))));
}

double result_of(TapeOp op, const std::array<double, 3>& x, const FloatFormat& format) {
    using enum OperationKind;
    return visit_operation<rounded, exact, next_or_converted, sign>(op, [&]<TapeOp known_op>() {
        return with_operands<known_op>(
            [&](auto... operands) { return Operation<known_op>::computed(operands..., format); },
            [&](std::size_t k) { return x[k]; });
    });
}

ErrorFactors error_factors_of(const TapeNode& node, const std::array<OperandError, 3>& x, NodeId chosen) {
    const auto quotients_of_kind = [&]<TapeOp op>() {
        return with_operands<op>([](const auto&... operands) { return Operation<op>::error_factors(operands...); },
                                 [&](std::size_t k) -> const OperandError& { return x[k]; });
    };
    switch (kind_of(node.op)) {
        case OperationKind::rounded:
        case OperationKind::exact:
        case OperationKind::sign:
            return visit_operation<OperationKind::rounded, OperationKind::exact, OperationKind::sign>(
                node.op, quotients_of_kind);
        case OperationKind::next_or_converted: return {1};
        case OperationKind::comparison: return {1, -1};  // stands for the difference of its sides
        case OperationKind::choice: {
            ErrorFactors q;
            q[std::ranges::find(node.operands, chosen) - node.operands.begin()] = 1;
            return q;
        }
        case OperationKind::called:
        case OperationKind::given:
        case OperationKind::logic: return {};
    }
    return {};
}

}  // namespace lostbits::measure::attribution
