// A tape: every operation of one run of a formula in the order of execution, its operands and what the format made of
// it. Recorded writes it; what comes after (exact values, adjoints, C, FPCore, LaTeX) are walks of it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "number/format.hpp"

namespace lostbits {

/// `constant` is an integer of the formula's text, `convert` the way to or from a wider format; from `less` on the
/// values are decisions, 1 or 0.
enum class TapeOp : std::uint8_t {
    input,
    constant,
    add,
    sub,
    mul,
    div,
    sqrt,
    fma,
    neg,
    abs,
    copysign,
    min,
    max,
    select,
    next_up,
    next_down,
    convert,
    less,
    less_equal,
    greater,
    greater_equal,
    both,
    either,
    opposite,
    any
};

inline constexpr std::array<std::string_view, 25> tape_op_names{
    "input",      "constant", "add",           "sub",  "mul",    "div",      "sqrt",      "fma",     "neg",
    "abs",        "copysign", "min",           "max",  "select", "next_up",  "next_down", "convert", "less",
    "less_equal", "greater",  "greater_equal", "both", "either", "opposite", "any"};

inline constexpr bool is_decision(TapeOp op) { return op >= TapeOp::less; }
inline constexpr bool is_comparison(TapeOp op) { return op >= TapeOp::less && op <= TapeOp::greater_equal; }
/// Neither input nor constant: something was done.
inline constexpr bool is_operation(TapeOp op) { return op > TapeOp::constant && op < TapeOp::less; }

using NodeId = std::int32_t;
inline constexpr NodeId no_node = -1;

struct TapeNode {
    TapeOp op = TapeOp::constant;
    std::uint8_t format = 0;  ///< of the result: its place in `Tape::formats`
    /// Operands in the formula's order; select's are the decision and its two sides, an input's first is its number, a
    /// constant's its value.
    std::array<NodeId, 3> operands{no_node, no_node, no_node};
    double value = 0;             ///< a number of the format, or a decision
    std::string_view label = {};  ///< as `named` gave it; a literal of the source
};

/// `hit` is the decision of the form, the others numbers; as in `Hit`.
struct TapeOutputs {
    NodeId hit = no_node, t = no_node, near = no_node, far = no_node;
};

class Tape {
public:
    std::vector<TapeNode> nodes;
    std::vector<FloatFormat> formats;
    TapeOutputs outputs;
    /// For a form that marches: the length of the tape after each sample of the field.
    std::vector<std::size_t> samples;
    /// Answers yes to every loop, for a tape of all that a form can ever do.
    bool every_loop = false;

    [[nodiscard]] const TapeNode& operator[](NodeId i) const { return nodes[static_cast<std::size_t>(i)]; }
    [[nodiscard]] TapeNode& operator[](NodeId i) { return nodes[static_cast<std::size_t>(i)]; }
    [[nodiscard]] const FloatFormat& format_of(NodeId i) const { return formats[(*this)[i].format]; }
    [[nodiscard]] NodeId size() const { return static_cast<NodeId>(nodes.size()); }

    /// Keeps the memory: a map records a million tapes one after the other.
    void clear() {
        nodes.clear();
        formats.clear();
        samples.clear();
        outputs = {};
        inputs_ = 0;
    }
    NodeId add(TapeOp op, const FloatFormat& format, double value, NodeId a = no_node, NodeId b = no_node,
               NodeId c = no_node) {
        nodes.push_back({op, place_of(format), {a, b, c}, value, {}});
        return size() - 1;
    }
    NodeId add_input(const FloatFormat& format, double value) { return add(TapeOp::input, format, value, inputs_++); }

    /// Names an operation, once: a later name for the same value is another letter of the source for it.
    void name(NodeId i, std::string_view label) {
        if (TapeNode& n = (*this)[i]; n.label.empty() && is_operation(n.op)) n.label = label;
    }

    /// The tape that this thread records on; null: none, and then Recorded is its number alone.
    static Tape*& current() {
        static thread_local Tape* tape = nullptr;
        return tape;
    }

    /// Records on `tape` for the lifetime of the scope.
    class Scope {
    public:
        explicit Scope(Tape& tape) : before_(current()) { current() = &tape; }
        ~Scope() { current() = before_; }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        Tape* before_;
    };

private:
    std::uint8_t place_of(const FloatFormat& format) {
        for (std::size_t i = 0; i < formats.size(); ++i) {
            if (formats[i] == format) return static_cast<std::uint8_t>(i);
        }
        formats.push_back(format);
        return static_cast<std::uint8_t>(formats.size() - 1);
    }
    NodeId inputs_ = 0;
};

}  // namespace lostbits
