// Dual: how sensitive is the problem itself? A value and its gradient with respect to the inputs, by forward
// differentiation: the same formula, the chain rule applied to each operation.
#pragma once

#include <array>
#include <cstddef>

#include "number/concept.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// x and ∂x/∂(input i), i < N, in the arithmetic F. Decisions are those of the value; `select` takes the side of the
/// value, so at a kink the gradient is one-sided. √ has no derivative at zero: division by zero says so in F's words.
template <class F, std::size_t N>
class Dual {
public:
    using Gradient = std::array<F, N>;

    Dual() : Dual(0) {}
    explicit Dual(int x) : value_(F(x)), gradient_(constant()) {}
    explicit Dual(const F& x) requires(!std::same_as<F, int>) : value_(x), gradient_(constant()) {}
    Dual(const F& x, const Gradient& gradient) : value_(x), gradient_(gradient) {}

    /// Input number i with this value: ∂x/∂(input i) = 1.
    static Dual input(const F& x, std::size_t i) {
        Dual d(x);
        d.gradient_[i] = F(1);
        return d;
    }

    [[nodiscard]] const F& value() const { return value_; }
    [[nodiscard]] const F& derivative(std::size_t i) const { return gradient_[i]; }

    friend Dual operator+(const Dual& a, const Dual& b) {
        return with(a.value_ + b.value_, [&](std::size_t i) { return a.gradient_[i] + b.gradient_[i]; });
    }
    friend Dual operator-(const Dual& a, const Dual& b) {
        return with(a.value_ - b.value_, [&](std::size_t i) { return a.gradient_[i] - b.gradient_[i]; });
    }
    friend Dual operator*(const Dual& a, const Dual& b) {
        return with(a.value_ * b.value_,
                    [&](std::size_t i) { return a.gradient_[i] * b.value_ + a.value_ * b.gradient_[i]; });
    }
    /// (a/b)' = (a' − (a/b) b')/b
    friend Dual operator/(const Dual& a, const Dual& b) {
        const F q = a.value_ / b.value_;
        return with(q, [&](std::size_t i) { return (a.gradient_[i] - q * b.gradient_[i]) / b.value_; });
    }
    friend Dual operator-(const Dual& a) {
        return with(-a.value_, [&](std::size_t i) { return -a.gradient_[i]; });
    }
    Dual& operator+=(const Dual& b) { return *this = *this + b; }
    Dual& operator-=(const Dual& b) { return *this = *this - b; }
    Dual& operator*=(const Dual& b) { return *this = *this * b; }

    friend mask_t<F> operator<(const Dual& a, const Dual& b) { return a.value_ < b.value_; }
    friend mask_t<F> operator<=(const Dual& a, const Dual& b) { return a.value_ <= b.value_; }
    friend mask_t<F> operator>(const Dual& a, const Dual& b) { return a.value_ > b.value_; }
    friend mask_t<F> operator>=(const Dual& a, const Dual& b) { return a.value_ >= b.value_; }

    /// (√a)' = a'/(2√a)
    friend Dual sqrt(const Dual& a) {
        const F root = sqrt(a.value_);
        return with(root, [&](std::size_t i) { return a.gradient_[i] / (root + root); });
    }
    friend Dual fma(const Dual& a, const Dual& b, const Dual& c) {
        return with(fma(a.value_, b.value_, c.value_), [&](std::size_t i) {
            return a.gradient_[i] * b.value_ + a.value_ * b.gradient_[i] + c.gradient_[i];
        });
    }
    friend Dual square(const Dual& a) {
        return with(square(a.value_),
                    [&](std::size_t i) { return a.gradient_[i] * a.value_ + a.value_ * a.gradient_[i]; });
    }
    friend Dual fma_square(const Dual& a, const Dual& c) {
        return with(fma_square(a.value_, c.value_), [&](std::size_t i) {
            return a.gradient_[i] * a.value_ + a.value_ * a.gradient_[i] + c.gradient_[i];
        });
    }
    friend Dual abs(const Dual& a) {
        const auto negative = a.value_ < F(0);
        return with(abs(a.value_), [&](std::size_t i) { return select(negative, -a.gradient_[i], a.gradient_[i]); });
    }
    /// |a| with the sign of b; b's own derivative plays no part but at its zero.
    friend Dual copysign(const Dual& a, const Dual& b) {
        const F result = copysign(a.value_, b.value_);
        const auto same = (a.value_ < F(0) && result < F(0)) || (!(a.value_ < F(0)) && !(result < F(0)));
        return with(result, [&](std::size_t i) { return select(same, a.gradient_[i], -a.gradient_[i]); });
    }
    friend Dual next_up(const Dual& a) { return {next_up(a.value_), a.gradient_}; }
    friend Dual next_down(const Dual& a) { return {next_down(a.value_), a.gradient_}; }
    friend Dual select(const mask_t<F>& mask, const Dual& a, const Dual& b) {
        return with(select(mask, a.value_, b.value_),
                    [&](std::size_t i) { return select(mask, a.gradient_[i], b.gradient_[i]); });
    }

private:
    template <std::size_t... I>
    static Gradient constant(std::index_sequence<I...>) {
        return {((void)I, F(0))...};
    }
    static Gradient constant() { return constant(std::make_index_sequence<N>{}); }
    template <class Rule>
    static Dual with(const F& value, const Rule& rule) {
        Dual d(value);
        for (std::size_t i = 0; i < N; ++i) d.gradient_[i] = rule(i);
        return d;
    }

    F value_;
    Gradient gradient_;
};

template <class F, std::size_t N>
inline constexpr bool stands_for_exact<Dual<F, N>> = stands_for_exact<F>;

static_assert(Number<Dual<double, 10>>);

}  // namespace lostbits
