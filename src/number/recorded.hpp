// Recorded: which operation lost the bits? A number of a format that writes down what is done to it.
#pragma once

#include "number/rounded.hpp"
#include "number/tape.hpp"

namespace lostbits {

/// A decision and its place on the tape.
class RecordedMask : public NotABool {
public:
    RecordedMask(bool value, NodeId node) : value_(value), node_(node) {}
    [[nodiscard]] bool value() const { return value_; }
    [[nodiscard]] NodeId node() const { return node_; }

    friend RecordedMask operator&&(const RecordedMask& a, const RecordedMask& b) {
        return noted(TapeOp::both, a.value_ && b.value_, a.node_, b.node_);
    }
    friend RecordedMask operator||(const RecordedMask& a, const RecordedMask& b) {
        return noted(TapeOp::either, a.value_ || b.value_, a.node_, b.node_);
    }
    friend RecordedMask operator!(const RecordedMask& a) { return noted(TapeOp::opposite, !a.value_, a.node_); }
    /// What a loop of a form asks. On the tape because without rounding the loop may have gone on.
    friend bool any_of(const RecordedMask& a) {
        return noted(TapeOp::any, a.value_, a.node_).value_ || (Tape::current() && Tape::current()->every_loop);
    }

    /// The format of a decision is none; the first of the tape stands for it.
    static RecordedMask noted(TapeOp op, bool value, NodeId a, NodeId b = no_node) {
        Tape* const tape = Tape::current();
        return {value,
                tape ? tape->add(op, tape->formats.empty() ? binary64 : tape->formats.front(), value ? 1 : 0, {a, b})
                     : no_node};
    }

private:
    bool value_;
    NodeId node_;
};

/// F and its node on the thread's tape (`Tape::Scope`). The values are F's own, to the bit. What an exact computation
/// would have given is found afterwards by running the tape again over an exact number (measure/blame/attribution.hpp),
/// so that a pixel of a map and a ray looked at closely share one recording and differ in the precision of what it is
/// compared with.
template <class F>
class Recorded {
public:
    explicit Recorded(int x) : value_(F(x)), node_(noted(TapeOp::constant, value_, x)) {}
    /// An input.
    template <std::floating_point X>
    explicit Recorded(X x) : value_(static_cast<F>(x)) {
        Tape* const tape = Tape::current();
        node_ = tape ? tape->add_input(format(), as_double(value_)) : no_node;
    }

    /// What stands on the tape already.
    static Recorded at(NodeId node, F value) { return Recorded(value, node); }

    [[nodiscard]] F value() const { return value_; }
    [[nodiscard]] NodeId node() const { return node_; }
    static FloatFormat format() {
        if constexpr (std::same_as<F, float>) return binary32;
        else if constexpr (std::same_as<F, double>) return binary64;
        else return F::format();
    }

    friend Recorded operator+(const Recorded& a, const Recorded& b) {
        return made(TapeOp::add, a.value_ + b.value_, a.node_, b.node_);
    }
    friend Recorded operator-(const Recorded& a, const Recorded& b) {
        return made(TapeOp::sub, a.value_ - b.value_, a.node_, b.node_);
    }
    friend Recorded operator*(const Recorded& a, const Recorded& b) {
        return made(TapeOp::mul, a.value_ * b.value_, a.node_, b.node_);
    }
    friend Recorded operator/(const Recorded& a, const Recorded& b) {
        return made(TapeOp::div, a.value_ / b.value_, a.node_, b.node_);
    }
    friend Recorded operator-(const Recorded& a) { return made(TapeOp::neg, -a.value_, a.node_); }
    Recorded& operator+=(const Recorded& b) { return *this = *this + b; }
    Recorded& operator-=(const Recorded& b) { return *this = *this - b; }
    Recorded& operator*=(const Recorded& b) { return *this = *this * b; }

    friend RecordedMask operator<(const Recorded& a, const Recorded& b) {
        return RecordedMask::noted(TapeOp::less, a.value_ < b.value_, a.node_, b.node_);
    }
    friend RecordedMask operator<=(const Recorded& a, const Recorded& b) {
        return RecordedMask::noted(TapeOp::less_equal, a.value_ <= b.value_, a.node_, b.node_);
    }
    friend RecordedMask operator>(const Recorded& a, const Recorded& b) {
        return RecordedMask::noted(TapeOp::greater, a.value_ > b.value_, a.node_, b.node_);
    }
    friend RecordedMask operator>=(const Recorded& a, const Recorded& b) {
        return RecordedMask::noted(TapeOp::greater_equal, a.value_ >= b.value_, a.node_, b.node_);
    }

    friend Recorded sqrt(const Recorded& a) { return made(TapeOp::sqrt, sqrt(a.value_), a.node_); }
    friend Recorded fma(const Recorded& a, const Recorded& b, const Recorded& c) {
        return made(TapeOp::fma, fma(a.value_, b.value_, c.value_), a.node_, b.node_, c.node_);
    }
    friend Recorded abs(const Recorded& a) { return made(TapeOp::abs, abs(a.value_), a.node_); }
    friend Recorded copysign(const Recorded& a, const Recorded& b) {
        return made(TapeOp::copysign, copysign(a.value_, b.value_), a.node_, b.node_);
    }
    friend Recorded next_up(const Recorded& a) { return made(TapeOp::next_up, next_up(a.value_), a.node_); }
    friend Recorded next_down(const Recorded& a) { return made(TapeOp::next_down, next_down(a.value_), a.node_); }
    friend Recorded min(const Recorded& a, const Recorded& b) {
        return made(TapeOp::min, a.value_ < b.value_ ? a.value_ : b.value_, a.node_, b.node_);
    }
    friend Recorded max(const Recorded& a, const Recorded& b) {
        return made(TapeOp::max, a.value_ > b.value_ ? a.value_ : b.value_, a.node_, b.node_);
    }
    friend Recorded select(const RecordedMask& mask, const Recorded& a, const Recorded& b) {
        return made(TapeOp::select, mask.value() ? a.value_ : b.value_, mask.node(), a.node_, b.node_);
    }

    /// What a call on numbers of the tape gave.
    friend Recorded called(const Call& of, std::span<const Recorded> arguments, const F& value) {
        Tape* const tape = Tape::current();
        if (!tape) return Recorded(value, no_node);
        std::vector<NodeId> nodes;
        for (const Recorded& a : arguments) nodes.push_back(a.node_);
        return Recorded(value, tape->add_call(of, format(), as_double(value), std::move(nodes)));
    }

    /// The same number in another format.
    template <class To>
    [[nodiscard]] Recorded<To> converted() const {
        return Recorded<To>::made(TapeOp::convert, static_cast<To>(as_double(value_)), node_);
    }

private:
    template <class>
    friend class Recorded;
    Recorded(F value, NodeId node) : value_(value), node_(node) {}

    static double as_double(const F& x) {
        if constexpr (std::is_floating_point_v<F>) return x;
        else return x.value();
    }
    static NodeId noted(TapeOp op, const F& value, NodeId a, NodeId b = no_node, NodeId c = no_node) {
        Tape* const tape = Tape::current();
        return tape ? tape->add(op, format(), as_double(value), {a, b, c}) : no_node;
    }
    static Recorded made(TapeOp op, const F& value, NodeId a, NodeId b = no_node, NodeId c = no_node) {
        return Recorded(value, noted(op, value, a, b, c));
    }

    F value_;
    NodeId node_;
};

/// Gives an operation the name that the source of the form has for its result.
template <class F>
const Recorded<F>& named(std::string_view label, const Recorded<F>& value) {
    if (Tape* const tape = Tape::current()) tape->name(value.node(), label);
    return value;
}

template <class F>
struct Part<Recorded<F>> {
    explicit Part(std::string_view name) {
        if (tape) tape->part = name;
    }
    ~Part() {
        if (tape) tape->part = {};
    }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

private:
    Tape* tape = Tape::current();
};

template <>
struct Wider<Recorded<float>> {
    using type = Recorded<double>;
    static type widen(const Recorded<float>& x) { return x.converted<double>(); }
    static Recorded<float> narrow(const type& x) { return x.converted<float>(); }
};

template <class F>
struct Wider<Recorded<BasicRounded<F>>> {
    using type = Recorded<double>;
    static type widen(const Recorded<BasicRounded<F>>& x) { return x.template converted<double>(); }
    static Recorded<BasicRounded<F>> narrow(const type& x) { return x.template converted<BasicRounded<F>>(); }
};

template <class F>
inline constexpr bool tells_of_operations<Recorded<F>> = true;

static_assert(Number<Recorded<float>> && Number<Recorded<double>> && Number<Recorded<RoundedAny>>);

}  // namespace lostbits
