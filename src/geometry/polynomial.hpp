// Polynomials of degree at most four over any number, and the number of their real roots.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "number/concept.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// Sign of a number: −1, 0 or +1; nothing if it is not known.
template <class E>
std::optional<int> known_sign(const E& x) {
    const auto told = [](const auto& mask) {
        if constexpr (std::same_as<std::decay_t<decltype(mask)>, bool>) return mask;
        else return mask.is_yes();
    };
    const E zero(0);
    if (told(x < zero)) return -1;
    if (told(x > zero)) return 1;
    if (told(x <= zero && x >= zero)) return 0;
    return std::nullopt;
}

/// c₀ + c₁ x + … + cₙ xⁿ. The zero polynomial has degree −1.
template <class T>
struct Polynomial {
    std::array<T, 5> c;
    int degree;

    [[nodiscard]] const T& of(int power) const { return c[static_cast<std::size_t>(power)]; }
    [[nodiscard]] T& of(int power) { return c[static_cast<std::size_t>(power)]; }
    [[nodiscard]] const T& leading() const { return of(degree); }

    [[nodiscard]] T at(const T& x) const {
        T y = leading();
        for (int i = degree - 1; i >= 0; --i) y = y * x + of(i);
        return y;
    }
    [[nodiscard]] Polynomial slope() const {
        Polynomial d{{}, degree - 1};
        for (int i = 1; i <= degree; ++i) d.of(i - 1) = T(i) * of(i);
        return d;
    }
    friend Polynomial operator-(Polynomial f) {
        for (int i = 0; i <= f.degree; ++i) f.of(i) = -f.of(i);
        return f;
    }
};

/// Removes the leading powers whose coefficients are known to be 0; false if that is not known.
template <class T>
bool trim(Polynomial<T>& f) {
    for (; f.degree >= 0; --f.degree) {
        const auto sign = known_sign(f.leading());
        if (!sign) return false;
        if (*sign != 0) break;
    }
    return true;
}

/// Selects division by leading coefficients for numbers whose exponents are limited. If such numbers were multiplied by
/// them instead, the numbers of a polynomial would soon be too large. They cannot prove an exact zero anyway.
template <class T>
inline constexpr bool divides_polynomials = requires(const T& x) {
    x.hi();
};

/// Remainder of f divided by g, and the quotient. Without division, both are multiplied by the same power of the
/// leading coefficient of g. The factor of the remainder is positive.
template <class T>
struct PolynomialDivision {
    Polynomial<T> quotient, rest;
};
template <class T>
PolynomialDivision<T> divide(const Polynomial<T>& f, const Polynomial<T>& g) {
    PolynomialDivision<T> d{{{}, f.degree - g.degree}, f};
    if constexpr (divides_polynomials<T>) {
        for (int k = d.quotient.degree; k >= 0; --k) {
            const T top = d.rest.of(g.degree + k) / g.leading();
            d.quotient.of(k) = top;
            for (int i = k; i < g.degree + k; ++i) d.rest.of(i) = d.rest.of(i) - top * g.of(i - k);
        }
        d.rest.degree = g.degree - 1;
        return d;
    }
    for (int k = d.quotient.degree; k >= 0; --k) {
        const T top = d.rest.of(g.degree + k);
        for (int i = k + 1; i <= d.quotient.degree; ++i) d.quotient.of(i) = g.leading() * d.quotient.of(i);
        d.quotient.of(k) = top;
        for (int i = 0; i < g.degree + k; ++i) {
            const T scaled = g.leading() * d.rest.of(i);
            d.rest.of(i) = i < k ? scaled : scaled - top * g.of(i - k);
        }
    }
    d.rest.degree = g.degree - 1;
    const bool odd = d.quotient.degree % 2 == 0;  // one step more than the difference of the degrees
    if (odd && known_sign(g.leading()) == -1) d.rest = -d.rest;
    return d;
}

/// Number of distinct real roots of f, and the common divisor of f and its slope, which has degree 0 if every root is
/// simple.
template <class T>
struct RootCount {
    int count;
    Polynomial<T> repeated;
};
/// Counts the roots by Sturm's theorem: the sign changes in f, f′, −remainder, −remainder, … at −∞, less those at ∞.
/// Nothing if a leading coefficient may be 0 but is not known to be. The first remainder of n x⁴ + p x² + q x + r is (p
/// x²)/2 + (3 q x)/4 + r; f must have no cubic term.
template <class T>
std::optional<RootCount<T>> count_roots(const Polynomial<T>& f) {
    Polynomial<T> before = f, now = f.slope();
    if (!trim(before) || !trim(now)) return std::nullopt;
    int changes = 0, sign = 1, mirrored = 1;
    const auto pass = [&](const Polynomial<T>& g) {
        const int next = *known_sign(g.leading()), at_minus = g.degree % 2 == 0 ? next : -next;
        changes += (at_minus != mirrored ? 1 : 0) - (next != sign ? 1 : 0);
        sign = next, mirrored = at_minus;
    };
    sign = *known_sign(before.leading()), mirrored = before.degree % 2 == 0 ? sign : -sign;
    pass(now);
    while (now.degree > 0) {
        Polynomial<T> rest{{}, 2};
        if (before.degree == 4) rest = {{T(4) * f.c[0], T(3) * f.c[1], T(2) * f.c[2], T(0), T(0)}, 2};
        else rest = divide(before, now).rest;
        if (!trim(rest)) return std::nullopt;
        if (rest.degree < 0) break;
        before = now, now = -rest;
        pass(now);
    }
    return RootCount<T>{changes, now};
}

}  // namespace lostbits
