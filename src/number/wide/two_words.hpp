// TwoWords: double-double arithmetic over any number type P. A number is hi + lo, two words of P. The operations are
// those of `Ball` on its midpoint, in the same order, so they give the same bits.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>

#include "number/concept.hpp"

namespace lostbits::number::wide {

/// 2^k in P, exactly, where k ≤ 0 and 2^k is a normal number. For floats, doubles and packs of them it is a constant.
template <class P>
P power_of_two(int k) {
    if constexpr (std::floating_point<P> || requires { typename P::Lanes; }) {
        return P(std::bit_cast<double>(static_cast<std::uint64_t>(1023 + k) << 52));
    } else {
        P x(1);
        for (; k <= -16; k += 16) x *= P(1) / P(1 << 16);
        return x / P(1 << -k);
    }
}

/// hi + lo with |lo| ≤ ulp(hi)/2. Unless a word underflows or overflows, the error of every operation is less than
/// `word_error` of its result (the bounds are listed at `Ball`). This holds for sums of any signs too.
template <class P>
struct TwoWords {
    P hi, lo;

    TwoWords() = default;
    TwoWords(const P& high, const P& low) : hi(high), lo(low) {}
    explicit TwoWords(int x) : hi(P(x)), lo(0) {}
    explicit TwoWords(const P& x) : hi(x), lo(0) {}

    TwoWords& operator+=(const TwoWords& b) { return *this = *this + b; }
    TwoWords& operator-=(const TwoWords& b) { return *this = *this - b; }
    TwoWords& operator*=(const TwoWords& b) { return *this = *this * b; }

    friend mask_t<P> operator<(const TwoWords& a, const TwoWords& b) {
        return a.hi < b.hi || (!(b.hi < a.hi) && a.lo < b.lo);
    }
    friend mask_t<P> operator<=(const TwoWords& a, const TwoWords& b) {
        return a.hi < b.hi || (a.hi <= b.hi && a.lo <= b.lo);
    }
    friend mask_t<P> operator>(const TwoWords& a, const TwoWords& b) { return b < a; }
    friend mask_t<P> operator>=(const TwoWords& a, const TwoWords& b) { return b <= a; }

    friend TwoWords abs(const TwoWords& a) { return select(a.hi < P(0), -a, a); }
    friend TwoWords copysign(const TwoWords& a, const TwoWords& b) {
        const TwoWords magnitude = abs(a);
        return select(copysign(P(1), b.hi) < P(0), -magnitude, magnitude);
    }
    friend TwoWords select(const mask_t<P>& mask, const TwoWords& a, const TwoWords& b) {
        return {select(mask, a.hi, b.hi), select(mask, a.lo, b.lo)};
    }
    /// a b + c, rounded twice: the product and the sum.
    friend TwoWords fma(const TwoWords& a, const TwoWords& b, const TwoWords& c) { return a * b + c; }
    /// Returns a + 2 `word_error` |a|, or a plus the smallest positive number of P if that is larger. Operations are
    /// accurate to `word_error`, so this is the distance to a neighbour.
    friend TwoWords next_up(const TwoWords& a) {
        return a + TwoWords(max(abs(a.hi) * power_of_two<P>(-101), next_up(P(0))));
    }
    friend TwoWords next_down(const TwoWords& a) { return -next_up(-a); }
};

inline constexpr double word_error = 0x1p-102;

/// a + b, exactly (2Sum, as `two_sum` of error_free.hpp).
template <class P>
TwoWords<P> sum_of(const P& a, const P& b) {
    const P s = a + b, bb = s - a;
    return {s, (a - (s - bb)) + (b - bb)};
}

/// a + b, exactly, where |a| ≥ |b| (Fast2Sum, as `quick_two_sum`).
template <class P>
TwoWords<P> ordered_sum(const P& a, const P& b) {
    const P s = a + b;
    return {s, b - (s - a)};
}

/// a b, exactly (as `two_product`).
template <class P>
TwoWords<P> product_of(const P& a, const P& b) {
    const P p = a * b;
    return {p, fma(a, b, -p)};
}

template <class P>
TwoWords<P> operator-(const TwoWords<P>& a) {
    return {-a.hi, -a.lo};
}

template <class P>
TwoWords<P> operator+(const TwoWords<P>& a, const TwoWords<P>& b) {
    const TwoWords<P> s = sum_of(a.hi, b.hi), t = sum_of(a.lo, b.lo);
    const TwoWords<P> v = ordered_sum<P>(s.hi, s.lo + t.hi);
    return ordered_sum<P>(v.hi, t.lo + v.lo);
}
template <class P>
TwoWords<P> operator-(const TwoWords<P>& a, const TwoWords<P>& b) {
    return a + (-b);
}

template <class P>
TwoWords<P> operator*(const TwoWords<P>& a, const TwoWords<P>& b) {
    const TwoWords<P> p = product_of(a.hi, b.hi);
    return ordered_sum<P>(p.hi, p.lo + fma(a.hi, b.lo, a.lo * b.hi));
}
template <class P>
TwoWords<P> operator*(const TwoWords<P>& a, const P& b) {
    const TwoWords<P> p = product_of(a.hi, b);
    return ordered_sum<P>(p.hi, p.lo + a.lo * b);
}

template <class P>
TwoWords<P> operator/(const TwoWords<P>& a, const TwoWords<P>& b) {
    const P q = a.hi / b.hi;
    const P remainder = fma(-q, b.hi, a.hi);
    return ordered_sum<P>(q, (remainder + (a.lo - q * b.lo)) / b.hi);
}
template <class P>
TwoWords<P> operator/(const TwoWords<P>& a, const P& b) {
    const P q = a.hi / b;
    const P remainder = fma(-q, b, a.hi);
    return ordered_sum<P>(q, (remainder + a.lo) / b);
}

template <class P>
TwoWords<P> sqrt(const TwoWords<P>& a) {
    using lostbits::sqrt;
    const P s = sqrt(a.hi);
    return ordered_sum<P>(s, (a.lo + fma(-s, s, a.hi)) / (P(2) * s));
}

/// (x + y) + z
template <class X>
X sum_of_three(const X& x, const X& y, const X& z) {
    return (x + y) + z;
}

static_assert(Number<TwoWords<double>>);

}  // namespace lostbits::number::wide
