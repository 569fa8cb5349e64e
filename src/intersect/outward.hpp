// Interval arithmetic inside a form, as in pbrt-v4 on the CPU: each bound is rounded to nearest and then replaced by
// its neighbour outward. This arithmetic is itself under test; the enclosures of lostbits are in number/.
#pragma once

#include "geometry/vec.hpp"

namespace lostbits::intersect {

/// [lo, hi] over the number under test. In exact arithmetic, whose numbers have no neighbours, lo = hi = the value.
template <Number T>
struct OutwardInterval {
    T lo;
    T hi;

    explicit OutwardInterval(int x) : lo(T(x)), hi(T(x)) {}
    explicit OutwardInterval(const T& x) : lo(x), hi(x) {}
    OutwardInterval(const T& low, const T& high) : lo(low), hi(high) {}

    friend OutwardInterval operator+(const OutwardInterval& a, const OutwardInterval& b) {
        return {next_down(a.lo + b.lo), next_up(a.hi + b.hi)};
    }
    friend OutwardInterval operator-(const OutwardInterval& a, const OutwardInterval& b) {
        return {next_down(a.lo - b.hi), next_up(a.hi - b.lo)};
    }
    friend OutwardInterval operator*(const OutwardInterval& a, const OutwardInterval& b) {
        const T p = a.lo * b.lo, q = a.hi * b.lo, r = a.lo * b.hi, s = a.hi * b.hi;
        return {next_down(min(min(p, q), min(r, s))), next_up(max(max(p, q), max(r, s)))};
    }
    /// If b contains zero, the quotient is (−1/0, 1/0), the whole line.
    friend OutwardInterval operator/(const OutwardInterval& a, const OutwardInterval& b) {
        const mask_t<T> has_zero = b.lo <= T(0) && b.hi >= T(0);
        const T p = a.lo / b.lo, q = a.hi / b.lo, r = a.lo / b.hi, s = a.hi / b.hi;
        return {select(has_zero, T(-1) / T(0), next_down(min(min(p, q), min(r, s)))),
                select(has_zero, T(1) / T(0), next_up(max(max(p, q), max(r, s))))};
    }
    /// A sum of squares can have a lower bound just below zero, whose root is NaN. `max` then returns 0, as pbrt's
    /// max(0, NextFloatDown(sqrt(x))) does.
    friend OutwardInterval sqrt(const OutwardInterval& a) {
        return {max(next_down(sqrt(a.lo)), T(0)), next_up(sqrt(a.hi))};
    }
    /// x² ≥ 0 for every x. A product of two equal intervals would not be known to be nonnegative.
    friend OutwardInterval square(const OutwardInterval& a) {
        const T low = abs(a.lo), high = abs(a.hi);
        const mask_t<T> has_zero = a.lo <= T(0) && a.hi >= T(0);
        const T least = min(low, high), most = max(low, high);
        return {select(has_zero, T(0), next_down(square(least))), next_up(square(most))};
    }
    [[nodiscard]] T middle() const { return (lo + hi) / T(2); }
};

}  // namespace lostbits::intersect
