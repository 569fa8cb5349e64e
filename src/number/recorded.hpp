// Recorded: which operation lost the bits? A number that tells its recorder what is done to it, in a format chosen at
// run time.
#pragma once

#include <vector>

#include "number/recorder.hpp"

namespace lostbits {

/// The one way from the operators below to the recorder, out of line: a form has hundreds of them.
NodeId record(TapeOp op, NodeId a, NodeId b = no_node, NodeId c = no_node);

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
    /// Asked by the loops of a form. Recorded because without rounding the loop may have gone on.
    friend bool any_of(const RecordedMask& a) { return Recorder::current().goes_on(record(TapeOp::any, a.node_)); }

private:
    NodeId node_;
};

/// A number in the recorder's format, or (`in_double`) in binary64. Values are those of the format, to the bit. What an
/// exact computation would have given is found afterwards by running the tape again over an exact number
/// (measure/blame/attribution.hpp), so that a pixel of a map and a ray looked at closely share one recording and differ
/// in the precision of what it is compared with.
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
inline constexpr bool tells_of_operations<BasicRecorded<in_double>> = true;

static_assert(Number<Recorded> && Number<RecordedInDouble>);

}  // namespace lostbits
