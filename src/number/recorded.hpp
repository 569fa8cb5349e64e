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

/// Keeps the numbers and decisions of one evaluation, each under the index of the operation that made it. Operations
/// are computed in the format of their operands: the recorder's own, or binary64 for what a formula computes in double
/// inside.
///
/// The recorder is this thread's from its construction to its destruction, and its format is the thread's
/// `CurrentFormat`.
class Recorder {
public:
    explicit Recorder(const FloatFormat& format) : format_(format), before_(current_) { current_ = this; }
    virtual ~Recorder() { current_ = before_; }
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// The recorder of this thread; Error(Exit::internal) if it has none.
    static Recorder& current() {
        if (current_ == nullptr) [[unlikely]]
            refuse();
        return *current_;
    }

    /// Adds an integer of the formula's text, or an input, rounded to the recorder's format or to binary64.
    virtual NodeId constant(int x, bool in_double) = 0;
    virtual NodeId input(double x, bool in_double) = 0;
    /// The result of an operation, comparisons and logic included; operands in the order of `TapeNode::operands`.
    virtual NodeId apply(TapeOp op, const TapeOperands& of) = 0;
    /// The same number in binary64, or in the recorder's format.
    virtual NodeId convert(NodeId x, bool to_double) = 0;
    /// The value of a step that was computed as a whole (`Call`).
    virtual NodeId call(const Call& of, std::span<const NodeId> arguments, double value, bool in_double) = 0;
    /// The number, or 1 and 0 of a decision.
    [[nodiscard]] virtual double value(NodeId x) const = 0;
    /// True if a loop of the formula with this condition goes on.
    virtual bool goes_on(NodeId decision) = 0;
    /// Names an operation as the source of the form does.
    virtual void name(NodeId /*x*/, std::string_view /*label*/) {}
    /// Names all operations that follow, until the name is empty.
    virtual void name_all(std::string_view /*part*/) {}
    /// Says that a part of the formula depends on a decision (`decide`).
    virtual void add_sides(NodeId /*decision*/) {}
    /// Ends one sample of a march.
    virtual void end_sample() {}

    [[nodiscard]] const FloatFormat& format() const { return CurrentFormat::get(); }

private:
    [[noreturn]] static void refuse() {
        throw Error(Exit::internal, "a recorded number was used where nothing records: construct a Recorder first");
    }
    static inline constinit thread_local Recorder* current_ = nullptr;

    CurrentFormat::Scope format_;
    Recorder* before_;
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
        return RecordedMask(record(TapeOp::both, a.node_, b.node_));
    }
    friend RecordedMask operator||(const RecordedMask& a, const RecordedMask& b) {
        return RecordedMask(record(TapeOp::either, a.node_, b.node_));
    }
    friend RecordedMask operator!(const RecordedMask& a) { return RecordedMask(record(TapeOp::opposite, a.node_)); }
    /// Condition of a form's loops. It is recorded because without rounding the loop might have gone on.
    friend bool any_of(const RecordedMask& a) { return Recorder::current().goes_on(record(TapeOp::any, a.node_)); }

private:
    NodeId node_;
};

/// Records that the part of a formula which `f` computes depends on the decision, so that enclosures can follow both
/// sides.
template <class F>
auto decide(const RecordedMask& mask, const F& f) {
    Recorder::current().add_sides(mask.node());
    return f(mask);
}

/// A number in the recorder's format, or (`in_double`) in binary64. Its values are those of the format, to the bit. The
/// exact values are found afterwards, by running the tape again over an exact number
/// (measure/attribution/attribution.hpp). A pixel of a map and a single ray under study are recorded in the same way;
/// only the precision of the exact values differs.
template <bool in_double>
class BasicRecorded {
public:
    explicit BasicRecorded(int x) : node_(Recorder::current().constant(x, in_double)) {}
    /// An input.
    template <std::floating_point X>
    explicit BasicRecorded(X x) : node_(Recorder::current().input(x, in_double)) {}

    /// The number that the recorder has under this index.
    static BasicRecorded at(NodeId node) { return BasicRecorded(node, At()); }

    [[nodiscard]] NodeId node() const { return node_; }
    [[nodiscard]] auto value() const {
        const double x = Recorder::current().value(node_);
        if constexpr (in_double) return x;
        else return RoundedAny::holding(x);
    }
    static FloatFormat format() { return in_double ? binary64 : Recorder::current().format(); }

    friend BasicRecorded operator+(const BasicRecorded& a, const BasicRecorded& b) { return made(TapeOp::add, a, b); }
    friend BasicRecorded operator-(const BasicRecorded& a, const BasicRecorded& b) { return made(TapeOp::sub, a, b); }
    friend BasicRecorded operator*(const BasicRecorded& a, const BasicRecorded& b) { return made(TapeOp::mul, a, b); }
    friend BasicRecorded operator/(const BasicRecorded& a, const BasicRecorded& b) { return made(TapeOp::div, a, b); }
    friend BasicRecorded operator-(const BasicRecorded& a) { return made(TapeOp::neg, a); }
    BasicRecorded& operator+=(const BasicRecorded& b) { return *this = *this + b; }
    BasicRecorded& operator-=(const BasicRecorded& b) { return *this = *this - b; }
    BasicRecorded& operator*=(const BasicRecorded& b) { return *this = *this * b; }

    friend RecordedMask operator<(const BasicRecorded& a, const BasicRecorded& b) { return asked(TapeOp::less, a, b); }
    friend RecordedMask operator<=(const BasicRecorded& a, const BasicRecorded& b) {
        return asked(TapeOp::less_equal, a, b);
    }
    friend RecordedMask operator>(const BasicRecorded& a, const BasicRecorded& b) {
        return asked(TapeOp::greater, a, b);
    }
    friend RecordedMask operator>=(const BasicRecorded& a, const BasicRecorded& b) {
        return asked(TapeOp::greater_equal, a, b);
    }

    friend BasicRecorded sqrt(const BasicRecorded& a) { return made(TapeOp::sqrt, a); }
    friend BasicRecorded fma(const BasicRecorded& a, const BasicRecorded& b, const BasicRecorded& c) {
        return at(record(TapeOp::fma, a.node_, b.node_, c.node_));
    }
    friend BasicRecorded abs(const BasicRecorded& a) { return made(TapeOp::abs, a); }
    friend BasicRecorded copysign(const BasicRecorded& a, const BasicRecorded& b) {
        return made(TapeOp::copysign, a, b);
    }
    friend BasicRecorded next_up(const BasicRecorded& a) { return made(TapeOp::next_up, a); }
    friend BasicRecorded next_down(const BasicRecorded& a) { return made(TapeOp::next_down, a); }
    friend BasicRecorded min(const BasicRecorded& a, const BasicRecorded& b) { return made(TapeOp::min, a, b); }
    friend BasicRecorded max(const BasicRecorded& a, const BasicRecorded& b) { return made(TapeOp::max, a, b); }
    friend BasicRecorded select(const RecordedMask& mask, const BasicRecorded& a, const BasicRecorded& b) {
        return at(record(TapeOp::select, mask.node(), a.node_, b.node_));
    }

    /// The result of a call on recorded numbers.
    template <class Value>
    friend BasicRecorded called(const Call& of, std::span<const BasicRecorded> arguments, const Value& value) {
        std::vector<NodeId> nodes;
        for (const BasicRecorded& a : arguments) nodes.push_back(a.node_);
        double x;
        if constexpr (std::is_floating_point_v<Value>) x = value;
        else x = value.value();
        return at(Recorder::current().call(of, nodes, x, in_double));
    }

private:
    struct At {};
    BasicRecorded(NodeId node, At) : node_(node) {}
    static BasicRecorded made(TapeOp op, const BasicRecorded& a) { return at(record(op, a.node_)); }
    static BasicRecorded made(TapeOp op, const BasicRecorded& a, const BasicRecorded& b) {
        return at(record(op, a.node_, b.node_));
    }
    static RecordedMask asked(TapeOp op, const BasicRecorded& a, const BasicRecorded& b) {
        return RecordedMask(record(op, a.node_, b.node_));
    }

    NodeId node_;
};

using Recorded = BasicRecorded<false>;
using RecordedInDouble = BasicRecorded<true>;

/// Gives an operation the name that the source of the form has for its result.
template <bool in_double>
const BasicRecorded<in_double>& named(std::string_view label, const BasicRecorded<in_double>& value) {
    Recorder::current().name(value.node(), label);
    return value;
}

template <bool in_double>
struct Part<BasicRecorded<in_double>> {
    explicit Part(std::string_view name) { Recorder::current().name_all(name); }
    ~Part() { Recorder::current().name_all({}); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
};

template <>
struct Wider<Recorded> {
    using type = RecordedInDouble;
    static type widen(const Recorded& x) { return type::at(Recorder::current().convert(x.node(), true)); }
    static Recorded narrow(const type& x) { return Recorded::at(Recorder::current().convert(x.node(), false)); }
};

template <bool in_double>
inline constexpr bool traces_operations<BasicRecorded<in_double>> = true;

static_assert(Number<Recorded> && Number<RecordedInDouble>);

}  // namespace lostbits
