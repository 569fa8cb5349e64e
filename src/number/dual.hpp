// Dual: a value and its gradient with respect to the inputs, which measures the sensitivity of the problem itself.
// Forward-mode differentiation runs the same formula and applies the chain rule to each operation.
#pragma once

#include <algorithm>
#include <cstddef>

#include <boost/container/static_vector.hpp>

#include "number/concept.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// x and ∂x/∂(input i) in the arithmetic F. Each value stores the length of its own gradient, up to N, so one type
/// serves problems of many sizes. A constant has no stored gradient; its gradient is zero. Comparisons use the value.
/// `select` takes the gradient of the selected operand, so at a kink the gradient is one-sided. √ has no derivative at
/// zero. Its gradient there is da/(√a + √a) as F computes it, an infinity or NaN in IEEE arithmetic.
template <class F, std::size_t N>
class Dual {
public:
    using Gradient = boost::container::static_vector<F, N>;

    Dual() : Dual(0) {}
    explicit Dual(int x) : value_(F(x)) {}
    explicit Dual(const F& x) requires(!std::same_as<F, int>) : value_(x) {}
    Dual(const F& x, const Gradient& gradient) : value_(x), gradient_(gradient) {}

    /// Input i of `input_count` inputs, with the value x: ∂x/∂(input i) = 1.
    static Dual input(const F& x, std::size_t i, std::size_t input_count = N) {
        Dual d(x);
        for (std::size_t k = 0; k < input_count; ++k) d.gradient_.push_back(F(k == i ? 1 : 0));
        return d;
    }

    [[nodiscard]] const F& value() const { return value_; }
    /// Derivatives by input; empty for a constant.
    [[nodiscard]] const Gradient& gradient() const { return gradient_; }
    [[nodiscard]] F derivative(std::size_t i) const { return i < gradient_.size() ? gradient_[i] : F(0); }

    friend Dual operator+(const Dual& a, const Dual& b) {
        return binary_result(a.value_ + b.value_, a, b, [](const F& da, const F& db) { return da + db; });
    }
    friend Dual operator-(const Dual& a, const Dual& b) {
        return binary_result(a.value_ - b.value_, a, b, [](const F& da, const F& db) { return da - db; });
    }
    friend Dual operator*(const Dual& a, const Dual& b) {
        return binary_result(a.value_ * b.value_, a, b,
                             [&](const F& da, const F& db) { return da * b.value_ + a.value_ * db; });
    }
    /// (a/b)' = (a' − (a/b) b')/b
    friend Dual operator/(const Dual& a, const Dual& b) {
        const F q = a.value_ / b.value_;
        return binary_result(q, a, b, [&](const F& da, const F& db) { return (da - q * db) / b.value_; });
    }
    friend Dual operator-(const Dual& a) {
        return unary_result(-a.value_, a, [](const F& da) { return -da; });
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
        return unary_result(root, a, [&](const F& da) { return da / (root + root); });
    }
    friend Dual fma(const Dual& a, const Dual& b, const Dual& c) {
        const Dual p =
            binary_result(a.value_, a, b, [&](const F& da, const F& db) { return da * b.value_ + a.value_ * db; });
        return binary_result(fma(a.value_, b.value_, c.value_), p, c, [](const F& dp, const F& dc) { return dp + dc; });
    }
    friend Dual square(const Dual& a) {
        return unary_result(square(a.value_), a, [&](const F& da) { return da * a.value_ + a.value_ * da; });
    }
    friend Dual fma_square(const Dual& a, const Dual& c) {
        return binary_result(fma_square(a.value_, c.value_), a, c,
                             [&](const F& da, const F& dc) { return da * a.value_ + a.value_ * da + dc; });
    }
    friend Dual abs(const Dual& a) {
        const auto is_negative = a.value_ < F(0);
        return unary_result(abs(a.value_), a, [&](const F& da) { return select(is_negative, -da, da); });
    }
    /// |a| with the sign of b. Its derivative is that of a, or the negative of it if the sign changed. The derivative
    /// with respect to b is zero, except at b = 0, where the result jumps; it is taken as zero there too.
    friend Dual copysign(const Dual& a, const Dual& b) {
        const F result = copysign(a.value_, b.value_);
        const auto keeps_sign = (a.value_ < F(0) && result < F(0)) || (!(a.value_ < F(0)) && !(result < F(0)));
        return unary_result(result, a, [&](const F& da) { return select(keeps_sign, da, -da); });
    }
    friend Dual next_up(const Dual& a) { return {next_up(a.value_), a.gradient_}; }
    friend Dual next_down(const Dual& a) { return {next_down(a.value_), a.gradient_}; }
    friend Dual select(const mask_t<F>& mask, const Dual& a, const Dual& b) {
        return binary_result(select(mask, a.value_, b.value_), a, b,
                             [&](const F& da, const F& db) { return select(mask, da, db); });
    }

private:
    template <class Rule>
    static Dual unary_result(const F& value, const Dual& a, const Rule& rule) {
        Dual d(value);
        for (const F& da : a.gradient_) d.gradient_.push_back(rule(da));
        return d;
    }
    template <class Rule>
    static Dual binary_result(const F& value, const Dual& a, const Dual& b, const Rule& rule) {
        Dual d(value);
        const F zero(0);
        const std::size_t size_a = a.gradient_.size(), size_b = b.gradient_.size(),
                          input_count = std::max(size_a, size_b);
        for (std::size_t i = 0; i < input_count; ++i)
            d.gradient_.push_back(rule(i < size_a ? a.gradient_[i] : zero, i < size_b ? b.gradient_[i] : zero));
        return d;
    }

    F value_;
    Gradient gradient_;
};

template <class F, std::size_t N>
inline constexpr bool is_exact<Dual<F, N>> = is_exact<F>;

static_assert(Number<Dual<double, 10>>);

}  // namespace lostbits
