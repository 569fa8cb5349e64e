// Finds the struct of an operation of a tape.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "measure/attribution/operation_rows.hpp"

// A switch over kinds or operations must name all of them.
#pragma GCC diagnostic error "-Wswitch"

namespace lostbits::measure::attribution {

/// Calls f<op>() for an operation of one of these kinds.
template <OperationKind... kinds, class F>
decltype(auto) visit_operation(TapeOp op, const F& f) {
    switch (op) {
#define LOSTBITS_CASE(tape_op, name, kind_of_op, operands)                                                            \
    case TapeOp::tape_op:                                                                                             \
        if constexpr (((OperationKind::kind_of_op == kinds) || ...)) return f.template operator()<TapeOp::tape_op>(); \
        else break;
        LOSTBITS_TAPE_OPERATIONS(LOSTBITS_CASE)
#undef LOSTBITS_CASE
    }
    throw std::logic_error("an operation of another kind");
}

/// Calls f(operand(0), …) with as many operands as the operation has.
template <TapeOp op, class F, class Operand>
decltype(auto) with_operands(const F& f, const Operand& operand) {
    return [&]<std::size_t... k>(std::index_sequence<k...>)->decltype(auto) { return f(operand(k)...); }
    (std::make_index_sequence<row_of(op).operand_count>());
}

/// Result of an operation on operand(0), … without rounding. Only for kinds that are given, rounded or exact.
template <class Exact, class Operand>
typename Exact::Number evaluate_without_rounding(const TapeNode& node, const Operand& operand) {
    using Number = typename Exact::Number;
    const auto evaluate = [&]<TapeOp op>() -> Number {
        if constexpr (is_given(op)) return Operation<op>::exact(Exact(), node);
        else
            return with_operands<op>([](const auto&... x) -> Number { return Operation<op>::exact(Exact(), x...); },
                                     operand);
    };
    return visit_operation<OperationKind::given, OperationKind::rounded, OperationKind::exact>(node.op, evaluate);
}

constexpr const OperationText& text_of(TapeOp op) {
    switch (op) {
#define LOSTBITS_CASE(tape_op, name, kind, operands) \
    case TapeOp::tape_op: return Operation<TapeOp::tape_op>::text;
        LOSTBITS_TAPE_OPERATIONS(LOSTBITS_CASE)
#undef LOSTBITS_CASE
    }
    throw std::logic_error("not an operation");
}

static_assert(std::ranges::all_of(tape_operations,
                                  [](const TapeOpRow& row) {
                                      const bool rounds = row.kind == OperationKind::rounded ||
                                                          row.kind == OperationKind::next_or_converted;
                                      const OperationText& text = text_of(row.op);
                                      return !rounds || !text.c_wide.empty() || !text.missing_in_c.empty();
                                  }),
              "explain --c: an operation that rounds has no text for formats that C lacks");

/// True if the decision holds.
template <class Decider>
bool holds(TapeOp op, const Decider& decider) {
    return visit_operation<OperationKind::comparison, OperationKind::logic>(
        op, [&]<TapeOp decision>() { return Operation<decision>::holds(decider); });
}

/// The operand that a choice selects.
template <class Decider>
NodeId chosen_side(const TapeNode& node, const Decider& decider) {
    return visit_operation<OperationKind::choice>(node.op, [&]<TapeOp choice>() {
        const auto [first, second] = Operation<choice>::sides;
        return node.operands[Operation<choice>::takes_first(decider) ? first : second];
    });
}

}  // namespace lostbits::measure::attribution
