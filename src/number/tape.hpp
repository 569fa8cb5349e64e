// A tape: every operation of one run of a formula in the order of execution, with its operands and its result in the
// format. `Recorded` writes a tape; later steps (exact values, adjoints, C, FPCore) read it from front to back.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "number/concept.hpp"
#include "number/format.hpp"

namespace lostbits {

/// Kind of an operation: where its result comes from, and if it is rounded.
enum class OperationKind : std::uint8_t {
    given,              ///< an input, or an integer of the formula's text, which has no operands
    rounded,            ///< a number computed from numbers and rounded to the format
    exact,              ///< a number computed from one number of the format without rounding
    called,             ///< a number computed from many as a whole, without intermediate rounding; its operands are in
                        ///< `Tape::calls`
    next_or_converted,  ///< a number converted to another one: a neighbour, or the nearest number of another format
    sign,               ///< a number with the sign of another
    choice,             ///< one of two numbers
    comparison,         ///< a decision about two numbers; the value of a decision is 1 or 0
    logic               ///< a decision made from decisions
};

/// All operations of a tape: enumerator, name in files, kind, number of operands. This is the only list of operations.
/// All other properties of an operation are in its struct in measure/attribution/operations.hpp; a row without a struct
/// does not compile.
///
/// `constant` is an integer of the formula's text, `call` a step that a form takes as a whole, `convert` the conversion
/// to or from a wider format, `any` the condition of a loop.
// clang-format off
#define LOSTBITS_TAPE_OPERATIONS(row)                   \
    row(input,         "input",         given,      0)  \
    row(constant,      "constant",      given,      0)  \
    row(add,           "add",           rounded,    2)  \
    row(sub,           "sub",           rounded,    2)  \
    row(mul,           "mul",           rounded,    2)  \
    row(div,           "div",           rounded,    2)  \
    row(sqrt,          "sqrt",          rounded,    1)  \
    row(fma,           "fma",           rounded,    3)  \
    row(call,          "call",          called,     0)  \
    row(neg,           "neg",           exact,      1)  \
    row(abs,           "abs",           exact,      1)  \
    row(copysign,      "copysign",      sign,       2)  \
    row(min,           "min",           choice,     2)  \
    row(max,           "max",           choice,     2)  \
    row(select,        "select",        choice,     3)  \
    row(next_up,       "next_up",       next_or_converted,      1)  \
    row(next_down,     "next_down",     next_or_converted,      1)  \
    row(convert,       "convert",       next_or_converted,      1)  \
    row(less,          "less",          comparison, 2)  \
    row(less_equal,    "less_equal",    comparison, 2)  \
    row(greater,       "greater",       comparison, 2)  \
    row(greater_equal, "greater_equal", comparison, 2)  \
    row(logical_and,   "both",          logic,      2)  \
    row(logical_or,    "either",        logic,      2)  \
    row(logical_not,   "opposite",      logic,      1)  \
    row(any,           "any",           logic,      1)
// clang-format on

#define LOSTBITS_ENUMERATOR(op, name, kind, operand_count) op,
enum class TapeOp : std::uint8_t { LOSTBITS_TAPE_OPERATIONS(LOSTBITS_ENUMERATOR) };
#undef LOSTBITS_ENUMERATOR

struct TapeOpRow {
    TapeOp op;
    std::string_view name;
    OperationKind kind;
    std::size_t operand_count;
};

#define LOSTBITS_ROW(op, name, kind, operand_count) TapeOpRow{TapeOp::op, name, OperationKind::kind, operand_count},
inline constexpr std::array tape_operations{LOSTBITS_TAPE_OPERATIONS(LOSTBITS_ROW)};
#undef LOSTBITS_ROW

constexpr const TapeOpRow& row_of(TapeOp op) { return tape_operations[static_cast<std::size_t>(op)]; }
constexpr std::string_view name_of(TapeOp op) { return row_of(op).name; }
constexpr OperationKind kind_of(TapeOp op) { return row_of(op).kind; }

constexpr bool is_given(TapeOp op) { return kind_of(op) == OperationKind::given; }
constexpr bool is_comparison(TapeOp op) { return kind_of(op) == OperationKind::comparison; }
constexpr bool is_decision(TapeOp op) { return is_comparison(op) || kind_of(op) == OperationKind::logic; }
/// True for operations that compute a number.
constexpr bool is_operation(TapeOp op) { return !is_given(op) && !is_decision(op); }

using NodeId = std::int32_t;
inline constexpr NodeId no_node = -1;

struct TapeNode {
    TapeOp op = TapeOp::constant;
    std::uint8_t format = 0;  ///< format of the result: its index in `Tape::formats`
    /// Operands in the formula's order. The operands of `select` are the decision and its two sides. The first operand
    /// of an input is its index, that of a constant its value.
    std::array<NodeId, 3> operands{no_node, no_node, no_node};
    double value = 0;             ///< a number of the format, or a decision
    std::string_view label = {};  ///< the name that `named` gave; a literal of the source
};

/// A `call` on the tape: the call and its arguments.
struct TapeCall {
    NodeId node;
    Call callee;
    std::vector<NodeId> arguments;
};

/// Indices of the results: `hit` is the decision of the form; the others are numbers, as in `Hit`.
struct TapeOutputs {
    NodeId hit = no_node, t = no_node, near = no_node, far = no_node;
};

/// Operands of an operation. A missing operand is `no_node`.
struct TapeOperands {
    NodeId a = no_node, b = no_node, c = no_node;
};

class Tape {
public:
    std::vector<TapeNode> nodes;
    std::vector<FloatFormat> formats;
    std::vector<TapeCall> calls;
    TapeOutputs outputs;
    /// Length of the tape after each sample of the distance field, for a form that marches.
    std::vector<std::size_t> sample_ends;
    /// The decisions that a part of the formula depends on (`decide`).
    std::vector<NodeId> branch_decisions;
    /// If true, every loop condition holds, so that the tape has all operations that a form can ever do.
    bool runs_every_loop = false;
    /// The name of every operation that is recorded while this name is not empty (`Part`).
    std::string_view part_name = {};

    [[nodiscard]] const TapeNode& operator[](NodeId i) const { return nodes[i]; }
    [[nodiscard]] TapeNode& operator[](NodeId i) { return nodes[i]; }
    [[nodiscard]] const FloatFormat& format_of(NodeId i) const { return formats[(*this)[i].format]; }
    [[nodiscard]] NodeId size() const { return static_cast<NodeId>(nodes.size()); }
    [[nodiscard]] const TapeCall& call_at(NodeId i) const { return *std::ranges::find(calls, i, &TapeCall::node); }
    /// Nodes that a node is computed from: none for given numbers, all arguments for a call.
    [[nodiscard]] std::span<const NodeId> operands_of(NodeId i) const {
        const TapeNode& n = (*this)[i];
        if (n.op == TapeOp::call) return call_at(i).arguments;
        return std::span(n.operands).first(row_of(n.op).operand_count);
    }

    /// Clears the tape but keeps its memory: a map records a million tapes one after the other.
    void clear() {
        nodes.clear();
        formats.clear();
        calls.clear();
        sample_ends.clear();
        branch_decisions.clear();
        outputs = {};
        inputs_ = 0;
    }
    NodeId add(TapeOp op, const FloatFormat& format, double value, const TapeOperands& operands = {}) {
        nodes.push_back({op,
                         find_or_add_format(format),
                         {operands.a, operands.b, operands.c},
                         value,
                         is_operation(op) ? part_name : std::string_view()});
        return size() - 1;
    }
    NodeId add_call(const Call& callee, const FloatFormat& format, double value, std::vector<NodeId> arguments) {
        const NodeId node = add(TapeOp::call, format, value);
        nodes.back().label = {};  // a call has its own name, in every part of a form
        calls.push_back({node, callee, std::move(arguments)});
        return node;
    }
    NodeId add_input(const FloatFormat& format, double value) { return add(TapeOp::input, format, value, {inputs_++}); }

    /// Names an operation once. A later name is ignored: the source then has two names for the same value.
    void name(NodeId i, std::string_view label) {
        if (TapeNode& n = (*this)[i]; n.label.empty() && is_operation(n.op)) n.label = label;
    }

private:
    std::uint8_t find_or_add_format(const FloatFormat& format) {
        for (std::size_t i = 0; i < formats.size(); ++i) {
            if (formats[i] == format) return static_cast<std::uint8_t>(i);
        }
        formats.push_back(format);
        return static_cast<std::uint8_t>(formats.size() - 1);
    }
    NodeId inputs_ = 0;
};

}  // namespace lostbits
