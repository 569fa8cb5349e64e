// Double-double over any number: the operations of `Ball` on its midpoint, in the same order, so the same bits.
#pragma once

#include "number/concept.hpp"

namespace lostbits::measure::stages {

/// hi + lo with |lo| ≤ ulp(hi)/2. Every operation is off by less than `word_error` of its result while nothing
/// underflows or overflows (the bounds are listed at `Ball`): a sum whatever its signs, too.
template <class P>
struct TwoWords {
    P hi, lo;
};

inline constexpr double word_error = 0x1p-102;

/// a + b, exactly.
template <class P>
TwoWords<P> sum_of(const P& a, const P& b) {
    const P s = a + b, bb = s - a;
    return {s, (a - (s - bb)) + (b - bb)};
}

/// a + b, exactly, where |a| ≥ |b|.
template <class P>
TwoWords<P> ordered_sum(const P& a, const P& b) {
    const P s = a + b;
    return {s, b - (s - a)};
}

/// a b, exactly.
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
    const TwoWords<P> v = ordered_sum(s.hi, s.lo + t.hi);
    return ordered_sum(v.hi, t.lo + v.lo);
}
template <class P>
TwoWords<P> operator-(const TwoWords<P>& a, const TwoWords<P>& b) {
    return a + (-b);
}

template <class P>
TwoWords<P> operator*(const TwoWords<P>& a, const TwoWords<P>& b) {
    const TwoWords<P> p = product_of(a.hi, b.hi);
    return ordered_sum(p.hi, p.lo + fma(a.hi, b.lo, a.lo * b.hi));
}
template <class P>
TwoWords<P> operator*(const TwoWords<P>& a, const P& b) {
    const TwoWords<P> p = product_of(a.hi, b);
    return ordered_sum(p.hi, p.lo + a.lo * b);
}

template <class P>
TwoWords<P> operator/(const TwoWords<P>& a, const TwoWords<P>& b) {
    const P q = a.hi / b.hi;
    const P rest = fma(-q, b.hi, a.hi);
    return ordered_sum<P>(q, (rest + (a.lo - q * b.lo)) / b.hi);
}
template <class P>
TwoWords<P> operator/(const TwoWords<P>& a, const P& b) {
    const P q = a.hi / b;
    const P rest = fma(-q, b, a.hi);
    return ordered_sum<P>(q, (rest + a.lo) / b);
}

template <class P>
TwoWords<P> sqrt(const TwoWords<P>& a) {
    using lostbits::sqrt;
    const P s = sqrt(a.hi);
    return ordered_sum<P>(s, (a.lo + fma(-s, s, a.hi)) / (P(2) * s));
}

using lostbits::select;

template <class P>
TwoWords<P> select(const mask_t<P>& mask, const TwoWords<P>& a, const TwoWords<P>& b) {
    return {select(mask, a.hi, b.hi), select(mask, a.lo, b.lo)};
}

/// (x + y) + z
template <class X>
X sum_of_three(const X& x, const X& y, const X& z) {
    return (x + y) + z;
}

}  // namespace lostbits::measure::stages
