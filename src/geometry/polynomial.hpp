// Polynomials of degree at most four over any number, and the number of their real roots.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "number/concept.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// Sign of a number: −1, 0 or +1. Returns nothing if the sign is not known.
template <class E>
std::optional<int> known_sign(const E& x) {
    const auto is_yes = [](const auto& mask) {
        if constexpr (std::same_as<std::decay_t<decltype(mask)>, bool>) return mask;
        else return mask.is_yes();
    };
    const E zero(0);
    if (is_yes(x < zero)) return -1;
    if (is_yes(x > zero)) return 1;
    if (is_yes(x <= zero && x >= zero)) return 0;
    return std::nullopt;
}

/// c₀ + c₁ x + … + cₙ xⁿ. The zero polynomial has degree −1.
template <class T>
struct Polynomial {
    std::array<T, 5> c;
    int degree;

    [[nodiscard]] const T& coefficient(int power) const { return c[power]; }
    [[nodiscard]] T& coefficient(int power) { return c[power]; }
    [[nodiscard]] const T& leading() const { return coefficient(degree); }

    [[nodiscard]] T at(const T& x) const {
        T y = leading();
        for (int i = degree - 1; i >= 0; --i) y = y * x + coefficient(i);
        return y;
    }
    [[nodiscard]] Polynomial derivative() const {
        Polynomial result{{}, degree - 1};
        for (int i = 1; i <= degree; ++i) result.coefficient(i - 1) = T(i) * coefficient(i);
        return result;
    }
    friend Polynomial operator-(Polynomial f) {
        for (int i = 0; i <= f.degree; ++i) f.coefficient(i) = -f.coefficient(i);
        return f;
    }
};

/// Removes the leading powers whose coefficients are known to be 0. Returns false if a sign is not known.
template <class T>
bool trim(Polynomial<T>& f) {
    for (; f.degree >= 0; --f.degree) {
        const auto sign = known_sign(f.leading());
        if (!sign) return false;
        if (*sign != 0) break;
    }
    return true;
}

/// True for numbers with a limited exponent (enclosures around doubles). For these, division divides by the leading
/// coefficient, because cross-multiplying would soon overflow. It loses nothing: such numbers cannot prove that a
/// remainder is exactly 0.
template <class T>
inline constexpr bool has_limited_exponent = requires(const T& x) {
    x.hi();
};

/// Quotient and remainder of f divided by g. With an unlimited exponent, both are multiplied by a power of the leading
/// coefficient of g, so that no coefficient is divided. The remainder is then multiplied by −1 if that power is
/// negative, so that its factor is always positive.
template <class T>
struct PolynomialDivision {
    Polynomial<T> quotient, remainder;
};
template <class T>
PolynomialDivision<T> divide(const Polynomial<T>& f, const Polynomial<T>& g) {
    PolynomialDivision<T> division{{{}, f.degree - g.degree}, f};
    if constexpr (has_limited_exponent<T>) {
        for (int k = division.quotient.degree; k >= 0; --k) {
            const T quotient_term = division.remainder.coefficient(g.degree + k) / g.leading();
            division.quotient.coefficient(k) = quotient_term;
            for (int i = k; i < g.degree + k; ++i)
                division.remainder.coefficient(i) =
                    division.remainder.coefficient(i) - quotient_term * g.coefficient(i - k);
        }
        division.remainder.degree = g.degree - 1;
        return division;
    }

    // Multiplies by the leading coefficient of g in each step, in place of dividing by it.
    for (int k = division.quotient.degree; k >= 0; --k) {
        const T quotient_term = division.remainder.coefficient(g.degree + k);
        for (int i = k + 1; i <= division.quotient.degree; ++i)
            division.quotient.coefficient(i) = g.leading() * division.quotient.coefficient(i);
        division.quotient.coefficient(k) = quotient_term;
        for (int i = 0; i < g.degree + k; ++i) {
            const T scaled = g.leading() * division.remainder.coefficient(i);
            division.remainder.coefficient(i) = i < k ? scaled : scaled - quotient_term * g.coefficient(i - k);
        }
    }

    // The factor must not change the sign of the remainder.
    division.remainder.degree = g.degree - 1;
    const bool is_odd_power = division.quotient.degree % 2 == 0;  // the power is the difference of the degrees plus one
    if (is_odd_power && known_sign(g.leading()) == -1) division.remainder = -division.remainder;
    return division;
}

/// Number of distinct real roots of f, and the common divisor of f and its derivative. The divisor has degree 0 if
/// every root is simple.
template <class T>
struct RootCount {
    int count;
    Polynomial<T> common_divisor;
};
/// Remainder of f = n x⁴ + p x² + q x + r divided by f′, times 4: 2 p x² + 3 q x + 4 r. f must have no cubic term.
template <class T>
Polynomial<T> first_quartic_remainder(const Polynomial<T>& f) {
    return {{T(4) * f.c[0], T(3) * f.c[1], T(2) * f.c[2], T(0), T(0)}, 2};
}

/// Counts the distinct real roots of f. If f has degree 4, it must have no cubic term. Uses Sturm's theorem: the number
/// of roots is the number of sign changes in f, f′, −remainder, −remainder, … at −∞ minus that at ∞. Returns nothing if
/// a leading coefficient may be 0 but is not known to be 0.
template <class T>
std::optional<RootCount<T>> count_roots(const Polynomial<T>& f) {
    Polynomial<T> previous = f, current = f.derivative();
    if (!trim(previous) || !trim(current)) return std::nullopt;
    int root_count = 0, sign = 1, sign_at_minus_infinity = 1;
    const auto add_changes = [&](const Polynomial<T>& g) {
        const int next_sign = *known_sign(g.leading()),
                  next_at_minus_infinity = g.degree % 2 == 0 ? next_sign : -next_sign;
        root_count += (next_at_minus_infinity != sign_at_minus_infinity ? 1 : 0) - (next_sign != sign ? 1 : 0);
        sign = next_sign;
        sign_at_minus_infinity = next_at_minus_infinity;
    };

    sign = *known_sign(previous.leading());
    sign_at_minus_infinity = previous.degree % 2 == 0 ? sign : -sign;
    add_changes(current);
    while (current.degree > 0) {
        Polynomial<T> remainder =
            previous.degree == 4 ? first_quartic_remainder(f) : divide(previous, current).remainder;
        if (!trim(remainder)) return std::nullopt;
        if (remainder.degree < 0) break;
        previous = current;
        current = -remainder;
        add_changes(current);
    }
    return RootCount<T>{root_count, current};
}

}  // namespace lostbits
