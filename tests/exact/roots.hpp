// Places on a line, and their order: as enclosed numbers, or without an error.
#pragma once

#include "exact/enclosed.hpp"
#include "exact/whole.hpp"

namespace lostbits::exact {

/// A root of an equation of degree one or two.
template <class E>
struct Place;

template <>
struct Place<Enclosed> {
    Enclosed value;
};

/// (p + s √q)/m, m > 0, s one of −1, 0, 1.
template <>
struct Place<Whole> {
    Whole p, q, m;
    int s = 0;
};

/// n/m for m ≠ 0.
inline Place<Enclosed> fraction(const Enclosed& n, const Enclosed& m) { return {n / m}; }
inline Place<Whole> fraction(const Whole& n, const Whole& m) {
    if (sign(m) > 0) return {n, Whole(), m, 0};
    return {-n, Whole(), -m, 0};
}

/// n itself.
inline Place<Enclosed> place(const Enclosed& n) { return {n}; }
inline Place<Whole> place(const Whole& n) { return {n, Whole(), Whole(1), 0}; }
/// The number in a place that consists of one number.
inline const Enclosed& number_of(const Place<Enclosed>& a) { return a.value; }
inline const Whole& number_of(const Place<Whole>& a) { return a.p; }

/// a t² + 2 h t + c, a > 0, and q = h² − a c ≥ 0.
template <class E>
struct Quadratic {
    E a, h, c, q;
    Quadratic(const E& a_, const E& h_, const E& c_) : a(a_), h(h_), c(c_), q(h_ * h_ - a_ * c_) {}
};

/// (−h + s √q)/a, or c/(−h − s √q): the one that adds numbers of the same sign.
inline Place<Enclosed> root_of(const Quadratic<Enclosed>& x, int s) {
    const Enclosed r = root(x.q);
    const bool falls = x.h.high < 0;
    const Enclosed sum = falls ? r - x.h : r + x.h;  // |h| + √q
    if (s < 0) return {falls ? x.c / sum : -sum / x.a};
    return {falls ? sum / x.a : -x.c / sum};
}
inline Place<Whole> root_of(const Quadratic<Whole>& x, int s) { return {-x.h, x.q, x.a, s}; }

/// The sign of x + y √q.
inline int sign_of_two(const Whole& x, const Whole& y, const Whole& q) {
    const int first = sign(x), second = sign(q) == 0 ? 0 : sign(y);
    if (first * second >= 0) return first != 0 ? first : second;
    return first * sign(x * x - y * y * q);
}

inline int order(const Place<Enclosed>& a, const Place<Enclosed>& b) { return sign(a.value - b.value); }

/// The sign of x + y √q + z √k, the difference of two places: the sign of (x + y √q)² − z² k if the parts have
/// different signs.
inline int order(const Place<Whole>& a, const Place<Whole>& b) {
    const Whole x = a.p * b.m - b.p * a.m;
    if (a.s == 0 && b.s == 0) return sign(x);
    if (b.s == 0) return sign_of_two(x, a.s > 0 ? b.m : -b.m, a.q);
    if (a.s == 0) return sign_of_two(x, b.s > 0 ? -a.m : a.m, b.q);
    const Whole y = a.s > 0 ? b.m : -b.m, z = b.s > 0 ? -a.m : a.m;
    const int first = sign_of_two(x, y, a.q), second = sign(b.q) == 0 ? 0 : sign(z);
    if (first * second >= 0) return first != 0 ? first : second;
    const Whole xy = x * y;
    return first * sign_of_two(x * x + y * y * a.q - z * z * b.q, xy + xy, a.q);
}

}  // namespace lostbits::exact
