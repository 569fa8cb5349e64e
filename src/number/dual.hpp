// Dual: a value and its gradient with respect to the inputs, which measures the sensitivity of the problem itself.
// Forward differentiation runs the same formula and applies the chain rule to each operation.
#pragma once

#include <algorithm>
#include <cstddef>

#include <boost/container/static_vector.hpp>

#include "number/concept.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// x and ∂x/∂(input i) in the arithmetic F. Each value stores the length of its own gradient, up to N, so one type
/// serves problems of many sizes. A constant has no stored gradient; its gradient is zero. Decisions are those of the
/// value; `select` takes the side of the value, so at a kink the gradient is one-sided. √ has no derivative at zero;
/// its gradient there is da/(√a + √a) as F computes it, an infinity or NaN in IEEE arithmetic.
template <class F, std::size_t N>
class Dual {
public:
    using Gradient = boost::container::static_vector<F, N>;

    Dual() : Dual(0) {}
    explicit Dual(int x) : value_(F(x)) {}
    explicit Dual(const F& x) requires(!std::same_as<F, int>) : value_(x) {}
    Dual(const F& x, const Gradient& gradient) : value_(x), gradient_(gradient) {}

    /// Input number i of `inputs`, with this value: ∂x/∂(input i) = 1.
    static Dual input(const F& x, std::size_t i, std::size_t inputs = N) {
        Dual d(x);
        for (std::size_t k = 0; k < inputs; ++k) d.gradient_.push_back(F(k == i ? 1 : 0));
        return d;
    }

    [[nodiscard]] const F& value() const { return value_; }
    /// Derivatives by input; empty for a constant.
    [[nodiscard]] const Gradient& gradient() const { return gradient_; }
    [[nodiscard]] F derivative(std::size_t i) const { return i < gradient_.size() ? gradient_[i] : F(0); }

    friend Dual operator+(const Dual& a, const Dual& b) {
        return of_two(a.value_ + b.value_, a, b, [](const F& da, const F& db) { return da + db; });
    }
    friend Dual operator-(const Dual& a, const Dual& b) {
        return of_two(a.value_ - b.value_, a, b, [](const F& da, const F& db) { return da - db; });
    }
    friend Dual operator*(const Dual& a, const Dual& b) {
        return of_two(a.value_ * b.value_, a, b,
                      [&](const F& da, const F& db) { return da * b.value_ + a.value_ * db; });
    }
    /// (a/b)' = (a' − (a/b) b')/b
    friend Dual operator/(const Dual& a, const Dual& b) {
        const F q = a.value_ / b.value_;
        return of_two(q, a, b, [&](const F& da, const F& db) { return (da - q * db) / b.value_; });
    }
    friend Dual operator-(const Dual& a) {
        return of_one(-a.value_, a, [](const F& da) { return -da; });
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
        return of_one(root, a, [&](const F& da) { return da / (root + root); });
    }
    friend Dual fma(const Dual& a, const Dual& b, const Dual& c) {
        const Dual p = of_two(a.value_, a, b, [&](const F& da, const F& db) { return da * b.value_ + a.value_ * db; });
        return of_two(fma(a.value_, b.value_, c.value_), p, c, [](const F& dp, const F& dc) { return dp + dc; });
    }
    friend Dual square(const Dual& a) {
        return of_one(square(a.value_), a, [&](const F& da) { return da * a.value_ + a.value_ * da; });
    }
    friend Dual fma_square(const Dual& a, const Dual& c) {
        return of_two(fma_square(a.value_, c.value_), a, c,
                      [&](const F& da, const F& dc) { return da * a.value_ + a.value_ * da + dc; });
    }
    friend Dual abs(const Dual& a) {
        const auto negative = a.value_ < F(0);
        return of_one(abs(a.value_), a, [&](const F& da) { return select(negative, -da, da); });
    }
    /// |a| with the sign of b. The derivative of b is not used: at b = 0 the result jumps.
    friend Dual copysign(const Dual& a, const Dual& b) {
        const F result = copysign(a.value_, b.value_);
        const auto same = (a.value_ < F(0) && result < F(0)) || (!(a.value_ < F(0)) && !(result < F(0)));
        return of_one(result, a, [&](const F& da) { return select(same, da, -da); });
    }
    friend Dual next_up(const Dual& a) { return {next_up(a.value_), a.gradient_}; }
    friend Dual next_down(const Dual& a) { return {next_down(a.value_), a.gradient_}; }
    friend Dual select(const mask_t<F>& mask, const Dual& a, const Dual& b) {
        return of_two(select(mask, a.value_, b.value_), a, b,
                      [&](const F& da, const F& db) { return select(mask, da, db); });
    }

private:
    template <class Rule>
    static Dual of_one(const F& value, const Dual& a, const Rule& rule) {
        Dual d(value);
        for (const F& da : a.gradient_) d.gradient_.push_back(rule(da));
        return d;
    }
    template <class Rule>
    static Dual of_two(const F& value, const Dual& a, const Dual& b, const Rule& rule) {
        Dual d(value);
        const F zero(0);
        const std::size_t of_a = a.gradient_.size(), of_b = b.gradient_.size(), inputs = std::max(of_a, of_b);
        for (std::size_t i = 0; i < inputs; ++i)
            d.gradient_.push_back(rule(i < of_a ? a.gradient_[i] : zero, i < of_b ? b.gradient_[i] : zero));
        return d;
    }

    F value_;
    Gradient gradient_;
};

template <class F, std::size_t N>
inline constexpr bool is_exact<Dual<F, N>> = is_exact<F>;

static_assert(Number<Dual<double, 10>>);

}  // namespace lostbits
