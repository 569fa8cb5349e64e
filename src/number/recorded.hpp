// Recorded: a number that passes each of its operations to a recorder, in a format chosen at run time, to find the
// operation that lost the bits. The recorders are in recorders/: one writes a tape, one bounds every error.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "number/error.hpp"
#include "number/rounded.hpp"
#include "number/tape.hpp"

namespace lostbits {

/// Keeps the numbers and decisions of one evaluation, each under the index of the operation that computed it.
/// Operations are computed in the format of their operands: the recorder's own format, or binary64 in the parts that a
/// formula computes in double.
///
/// The recorder is this thread's current one from its construction to its destruction, and its format is the thread's
/// `CurrentFormat`.
class Recorder {
public:
    explicit Recorder(const FloatFormat& format) : format_(format), previous_(current_) { current_ = this; }
    virtual ~Recorder() { current_ = previous_; }
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// The recorder of this thread. Throws Error(ExitStatus::internal) if the thread has no recorder.
    static Recorder& current() {
        if (current_ == nullptr) [[unlikely]]
            fail_without_recorder();
        return *current_;
    }

    /// Adds an integer of the formula's text, or an input, rounded to the recorder's format or to binary64.
    virtual NodeId constant(int x, bool is_double) = 0;
    virtual NodeId input(double x, bool is_double) = 0;
    /// Adds an operation, which may be a comparison or a logical one, and returns its index. The operands are in the
    /// order of `TapeNode::operands`.
    virtual NodeId apply(TapeOp op, const TapeOperands& operands) = 0;
    /// Converts a number to binary64, or to the recorder's format.
    virtual NodeId convert(NodeId x, bool to_double) = 0;
    /// Adds the value of a step that was computed as a whole (`Call`).
    virtual NodeId call(const Call& callee, std::span<const NodeId> arguments, double value, bool is_double) = 0;
    /// The value of a number; for a decision, 1 or 0.
    [[nodiscard]] virtual double value(NodeId x) const = 0;
    /// True if a loop of the formula with this condition goes on.
    virtual bool continues_loop(NodeId decision) = 0;
    /// Labels an operation with its name in the form's source.
    virtual void name(NodeId /*x*/, std::string_view /*label*/) {}
    /// Gives this name to all following operations, until it is called with an empty name.
    virtual void name_following(std::string_view /*part*/) {}
    /// Records that a part of the formula depends on a decision (`decide`).
    virtual void add_branch(NodeId /*decision*/) {}
    /// Ends one sample of a march.
    virtual void end_sample() {}

    [[nodiscard]] const FloatFormat& format() const { return CurrentFormat::get(); }

private:
    [[noreturn]] static void fail_without_recorder() {
        throw Error(ExitStatus::internal,
                    "a recorded number was used on a thread without a Recorder: construct one first");
    }
    static inline constinit thread_local Recorder* current_ = nullptr;

    CurrentFormat::Scope format_;
    Recorder* previous_;
};

/// Passes an operation to the recorder. Out of line, because a form has hundreds of operations.
[[gnu::noinline]] inline NodeId record(TapeOp op, NodeId a, NodeId b = no_node, NodeId c = no_node) {
    return Recorder::current().apply(op, {a, b, c});
}

/// A decision of a recorded formula.
class RecordedMask : public NotABool {
public:
    explicit RecordedMask(NodeId node) : node_(node) {}
    [[nodiscard]] bool value() const { return Recorder::current().value(node_) != 0; }
    [[nodiscard]] NodeId node() const { return node_; }

    friend RecordedMask operator&&(const RecordedMask& a, const RecordedMask& b) {
        return RecordedMask(record(TapeOp::logical_and, a.node_, b.node_));
    }
    friend RecordedMask operator||(const RecordedMask& a, const RecordedMask& b) {
        return RecordedMask(record(TapeOp::logical_or, a.node_, b.node_));
    }
    friend RecordedMask operator!(const RecordedMask& a) { return RecordedMask(record(TapeOp::logical_not, a.node_)); }
    /// Condition of a form's loops. It is recorded because without rounding the loop might have gone on.
    friend bool any_of(const RecordedMask& a) {
        return Recorder::current().continues_loop(record(TapeOp::any, a.node_));
    }

private:
    NodeId node_;
};

/// Records that the part of a formula which `f` computes depends on the decision, so that enclosures can follow both
/// sides.
template <class F>
auto decide(const RecordedMask& mask, const F& f) {
    Recorder::current().add_branch(mask.node());
    return f(mask);
}

/// A number in the recorder's format, or (`is_double`) in binary64. Its values are those of the format, to the bit. The
/// exact values are found afterwards, by running the tape again over an exact number
/// (measure/attribution/attribution.hpp). The pixels of a map and a single ray under study are recorded in the same
/// way; only the precision of the exact values differs.
template <bool is_double>
class BasicRecorded {
public:
    explicit BasicRecorded(int x) : node_(Recorder::current().constant(x, is_double)) {}
    /// An input.
    template <std::floating_point X>
    explicit BasicRecorded(X x) : node_(Recorder::current().input(x, is_double)) {}

    /// The number with this index in the recorder.
    static BasicRecorded at(NodeId node) { return BasicRecorded(node, FromNodeTag()); }

    [[nodiscard]] NodeId node() const { return node_; }
    [[nodiscard]] auto value() const {
        const double x = Recorder::current().value(node_);
        if constexpr (is_double) return x;
        else return RoundedAny::from_value(x);
    }
    static FloatFormat format() { return is_double ? binary64 : Recorder::current().format(); }

    friend BasicRecorded operator+(const BasicRecorded& a, const BasicRecorded& b) {
        return record_number(TapeOp::add, a, b);
    }
    friend BasicRecorded operator-(const BasicRecorded& a, const BasicRecorded& b) {
        return record_number(TapeOp::sub, a, b);
    }
    friend BasicRecorded operator*(const BasicRecorded& a, const BasicRecorded& b) {
        return record_number(TapeOp::mul, a, b);
    }
    friend BasicRecorded operator/(const BasicRecorded& a, const BasicRecorded& b) {
        return record_number(TapeOp::div, a, b);
    }
    friend BasicRecorded operator-(const BasicRecorded& a) { return record_number(TapeOp::neg, a); }
    BasicRecorded& operator+=(const BasicRecorded& b) { return *this = *this + b; }
    BasicRecorded& operator-=(const BasicRecorded& b) { return *this = *this - b; }
    BasicRecorded& operator*=(const BasicRecorded& b) { return *this = *this * b; }

    friend RecordedMask operator<(const BasicRecorded& a, const BasicRecorded& b) {
        return record_decision(TapeOp::less, a, b);
    }
    friend RecordedMask operator<=(const BasicRecorded& a, const BasicRecorded& b) {
        return record_decision(TapeOp::less_equal, a, b);
    }
    friend RecordedMask operator>(const BasicRecorded& a, const BasicRecorded& b) {
        return record_decision(TapeOp::greater, a, b);
    }
    friend RecordedMask operator>=(const BasicRecorded& a, const BasicRecorded& b) {
        return record_decision(TapeOp::greater_equal, a, b);
    }

    friend BasicRecorded sqrt(const BasicRecorded& a) { return record_number(TapeOp::sqrt, a); }
    friend BasicRecorded fma(const BasicRecorded& a, const BasicRecorded& b, const BasicRecorded& c) {
        return at(record(TapeOp::fma, a.node_, b.node_, c.node_));
    }
    friend BasicRecorded abs(const BasicRecorded& a) { return record_number(TapeOp::abs, a); }
    friend BasicRecorded copysign(const BasicRecorded& a, const BasicRecorded& b) {
        return record_number(TapeOp::copysign, a, b);
    }
    friend BasicRecorded next_up(const BasicRecorded& a) { return record_number(TapeOp::next_up, a); }
    friend BasicRecorded next_down(const BasicRecorded& a) { return record_number(TapeOp::next_down, a); }
    friend BasicRecorded min(const BasicRecorded& a, const BasicRecorded& b) {
        return record_number(TapeOp::min, a, b);
    }
    friend BasicRecorded max(const BasicRecorded& a, const BasicRecorded& b) {
        return record_number(TapeOp::max, a, b);
    }
    friend BasicRecorded select(const RecordedMask& mask, const BasicRecorded& a, const BasicRecorded& b) {
        return at(record(TapeOp::select, mask.node(), a.node_, b.node_));
    }

    /// The result of a call on recorded numbers.
    template <class Value>
    friend BasicRecorded call_result(const Call& callee, std::span<const BasicRecorded> arguments, const Value& value) {
        std::vector<NodeId> nodes;
        for (const BasicRecorded& a : arguments) nodes.push_back(a.node_);
        double x;
        if constexpr (std::is_floating_point_v<Value>) x = value;
        else x = value.value();
        return at(Recorder::current().call(callee, nodes, x, is_double));
    }

private:
    struct FromNodeTag {};
    BasicRecorded(NodeId node, FromNodeTag) : node_(node) {}
    static BasicRecorded record_number(TapeOp op, const BasicRecorded& a) { return at(record(op, a.node_)); }
    static BasicRecorded record_number(TapeOp op, const BasicRecorded& a, const BasicRecorded& b) {
        return at(record(op, a.node_, b.node_));
    }
    static RecordedMask record_decision(TapeOp op, const BasicRecorded& a, const BasicRecorded& b) {
        return RecordedMask(record(op, a.node_, b.node_));
    }

    NodeId node_;
};

using Recorded = BasicRecorded<false>;
using RecordedInDouble = BasicRecorded<true>;

/// Labels the operation that computed `value` with its name in the form's source.
template <bool is_double>
const BasicRecorded<is_double>& named(std::string_view label, const BasicRecorded<is_double>& value) {
    Recorder::current().name(value.node(), label);
    return value;
}

template <bool is_double>
struct Part<BasicRecorded<is_double>> {
    explicit Part(std::string_view name) { Recorder::current().name_following(name); }
    ~Part() { Recorder::current().name_following({}); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
};

template <>
struct Wider<Recorded> {
    using type = RecordedInDouble;
    static type widen(const Recorded& x) { return type::at(Recorder::current().convert(x.node(), true)); }
    static Recorded narrow(const type& x) { return Recorded::at(Recorder::current().convert(x.node(), false)); }
};

template <bool is_double>
inline constexpr bool traces_operations<BasicRecorded<is_double>> = true;

static_assert(Number<Recorded> && Number<RecordedInDouble>);

}  // namespace lostbits
