// Counted: a native number that counts the operations of a formula, by kind.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "number/concept.hpp"
#include "number/format.hpp"

namespace lostbits {

/// Kinds of operations. `add` includes subtraction, `choose` includes select, min and max, and `sign` includes −x, |x|
/// and copysign. `neighbour` is the next number up or down. `convert` is a conversion to or from a wider format.
enum class Operation : std::uint8_t { add, mul, div, sqrt, fma, compare, choose, sign, neighbour, convert };

inline constexpr std::array<std::string_view, 10> operation_names{"add",     "mul",    "div",  "sqrt",      "fma",
                                                                  "compare", "choose", "sign", "neighbour", "convert"};

struct OperationCounts {
    std::array<std::uint64_t, operation_names.size()> counts{};
    [[nodiscard]] std::uint64_t operator[](Operation o) const { return counts[static_cast<std::size_t>(o)]; }
    std::uint64_t& operator[](Operation o) { return counts[static_cast<std::size_t>(o)]; }
    friend bool operator==(const OperationCounts&, const OperationCounts&) = default;
};

/// Operation counts of this thread since it last reset them.
inline OperationCounts& operation_counts() {
    static thread_local OperationCounts counts;
    return counts;
}

/// A number of F whose operations are counted. An operation whose operands are all constants is not counted, since a
/// compiler would fold it: `T(1) / T(2)` costs nothing. Common subexpressions are counted every time that the formula
/// contains them.
template <class F>
class Counted {
public:
    explicit Counted(int x) : value_(static_cast<F>(x)), is_constant_(true) {}
    /// An input.
    template <std::floating_point X>
    explicit Counted(X x) : value_(static_cast<F>(x)), is_constant_(false) {}

    [[nodiscard]] F value() const { return value_; }
    static constexpr FloatFormat format() { return sizeof(F) == sizeof(float) ? binary32 : binary64; }

    friend Counted operator+(const Counted& a, const Counted& b) {
        return counted_result(Operation::add, a.value_ + b.value_, a, b);
    }
    friend Counted operator-(const Counted& a, const Counted& b) {
        return counted_result(Operation::add, a.value_ - b.value_, a, b);
    }
    friend Counted operator*(const Counted& a, const Counted& b) {
        return counted_result(Operation::mul, a.value_ * b.value_, a, b);
    }
    friend Counted operator/(const Counted& a, const Counted& b) {
        return counted_result(Operation::div, a.value_ / b.value_, a, b);
    }
    friend Counted operator-(const Counted& a) { return counted_result(Operation::sign, -a.value_, a); }
    Counted& operator+=(const Counted& b) { return *this = *this + b; }
    Counted& operator-=(const Counted& b) { return *this = *this - b; }
    Counted& operator*=(const Counted& b) { return *this = *this * b; }

    friend bool operator<(const Counted& a, const Counted& b) {
        return count_unless_constant(Operation::compare, a, b), a.value_ < b.value_;
    }
    friend bool operator<=(const Counted& a, const Counted& b) {
        return count_unless_constant(Operation::compare, a, b), a.value_ <= b.value_;
    }
    friend bool operator>(const Counted& a, const Counted& b) {
        return count_unless_constant(Operation::compare, a, b), a.value_ > b.value_;
    }
    friend bool operator>=(const Counted& a, const Counted& b) {
        return count_unless_constant(Operation::compare, a, b), a.value_ >= b.value_;
    }

    friend Counted sqrt(const Counted& a) { return counted_result(Operation::sqrt, sqrt(a.value_), a); }
    friend Counted fma(const Counted& a, const Counted& b, const Counted& c) {
        return counted_result(Operation::fma, fma(a.value_, b.value_, c.value_), a, b, c);
    }
    friend Counted abs(const Counted& a) { return counted_result(Operation::sign, abs(a.value_), a); }
    friend Counted copysign(const Counted& a, const Counted& b) {
        return counted_result(Operation::sign, copysign(a.value_, b.value_), a, b);
    }
    friend Counted next_up(const Counted& a) { return counted_result(Operation::neighbour, next_up(a.value_), a); }
    friend Counted next_down(const Counted& a) { return counted_result(Operation::neighbour, next_down(a.value_), a); }
    friend Counted min(const Counted& a, const Counted& b) {
        return counted_result(Operation::choose, a.value_ < b.value_ ? a.value_ : b.value_, a, b);
    }
    friend Counted max(const Counted& a, const Counted& b) {
        return counted_result(Operation::choose, a.value_ > b.value_ ? a.value_ : b.value_, a, b);
    }
    /// Counted even if a and b are constants, since the mask is known only at run time.
    friend Counted select(bool mask, const Counted& a, const Counted& b) {
        ++operation_counts()[Operation::choose];
        return Counted(mask ? a.value_ : b.value_, false);
    }

    /// The same number in another format.
    template <class To>
    [[nodiscard]] Counted<To> converted() const {
        count_unless_constant(Operation::convert, *this);
        return Counted<To>(static_cast<To>(value_), is_constant_);
    }

private:
    template <class>
    friend class Counted;
    Counted(F value, bool is_constant) : value_(value), is_constant_(is_constant) {}

    template <class... X>
    static bool count_unless_constant(Operation kind, const X&... operands) {
        const bool is_constant = (operands.is_constant_ && ...);
        if (!is_constant) ++operation_counts()[kind];
        return is_constant;
    }
    template <class... X>
    static Counted counted_result(Operation kind, F value, const X&... operands) {
        return Counted(value, count_unless_constant(kind, operands...));
    }

    F value_;
    bool is_constant_;
};

template <>
struct Wider<Counted<float>> {
    using type = Counted<double>;
    static type widen(const Counted<float>& x) { return x.converted<double>(); }
    static Counted<float> narrow(const type& x) { return x.converted<float>(); }
};

static_assert(Number<Counted<float>> && Number<Counted<double>>);

}  // namespace lostbits
