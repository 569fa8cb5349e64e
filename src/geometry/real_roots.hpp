// Real roots of a polynomial of degree at most four: approximated in any arithmetic, and enclosed with a proof.
#pragma once

#include <algorithm>

#include "geometry/polynomial.hpp"

namespace lostbits {

inline double middle(double x) { return x; }
inline int precision_of(double) { return 53; }

/// Approximate roots: at most four numbers in ascending order.
template <class T>
struct ApproximateRoots {
    std::array<T, 4> x;
    int count = 0;

    void add(const T& root) { x[count++] = root; }
};

/// Finds the root of f between two numbers at which f has different signs, by Newton's method. Bisects if a Newton step
/// leaves the interval.
template <class A>
A approximate_root(const Polynomial<A>& f, A low, A high) {
    const Polynomial<A> slope = f.derivative();
    const bool is_rising = known_sign(middle(f.at(low))) == -1;
    const A half = A(1) / A(2);
    A x = middle(half * (low + high));
    for (int i = 0; i < 4 * precision_of(x); ++i) {
        const A value = middle(f.at(x));
        const auto sign = known_sign(value);
        if (!sign || *sign == 0) break;
        (is_rising == (*sign < 0) ? low : high) = x;

        // Tries a step of Newton, and bisects if it leaves the interval.
        const A slope_at_x = middle(slope.at(x));
        A next = known_sign(slope_at_x) == 0 ? x : middle(x - value / slope_at_x);
        const bool is_between = known_sign(A(next - low)) == 1 && known_sign(A(high - next)) == 1;
        if (!is_between) next = middle(half * (low + high));

        if (known_sign(A(next - x)) == 0 || known_sign(A(next - low)) == 0 || known_sign(A(high - next)) == 0)
            return next;
        x = next;
    }
    return x;
}

/// Approximates the roots within ±bound at which f changes sign. Between two neighbouring roots of its slope at which
/// the slope changes sign, f has one such root or none.
template <class A>
ApproximateRoots<A> approximate_roots(const Polynomial<A>& f, const A& bound) {
    ApproximateRoots<A> extrema, roots;
    if (f.degree > 1) extrema = approximate_roots(f.derivative(), bound);
    if (f.degree < 1) return roots;
    A low = -bound;
    auto sign_before = known_sign(middle(f.at(low)));
    for (int i = 0; i <= extrema.count; ++i) {
        const A high = i < extrema.count ? extrema.x[i] : bound;
        const auto sign_after = known_sign(middle(f.at(high)));
        if (sign_before && sign_after && *sign_before * *sign_after < 0) roots.add(approximate_root(f, low, high));
        if (sign_after != 0) {
            low = high;
            sign_before = sign_after;
        }
    }
    return roots;
}

/// An interval that holds exactly one root. `changes_sign` is true if the polynomial changes sign at the root;
/// `sign_beyond` is its sign beyond the root.
template <class E>
struct EnclosedRoot {
    E low, high, root;
    bool changes_sign;
    int sign_beyond;
};

/// All real roots of f in order, and a polynomial `simple` that has each root of f once.
template <class E>
struct EnclosedRoots {
    Polynomial<E> f, simple;
    std::array<EnclosedRoot<E>, 4> all;
    int count = 0;

    [[nodiscard]] const EnclosedRoot<E>& operator[](int i) const { return all[i]; }
    /// Compares root i with a point x: −1 if the root is below x, 0 if it is x, +1 if it is above x. Returns nothing if
    /// that is not known. `sign_relative_to_x(p)` is the sign of p − x. `sign_at_x()` returns the sign of `simple` at
    /// x. Between roots i − 1 and i + 1, that sign changes only at root i.
    template <class SignRelativeToX, class SignAtX>
    [[nodiscard]] std::optional<int> order(int i, const SignRelativeToX& sign_relative_to_x,
                                           const SignAtX& sign_at_x) const {
        const auto agrees = [](const std::optional<int>& sign, int expected) { return sign && *sign * expected >= 0; };
        const auto& [low, high, root, changes_sign, sign_beyond] = (*this)[i];
        const auto sign_of_low = sign_relative_to_x(low), sign_of_high = sign_relative_to_x(high);
        if (agrees(sign_of_low, 1)) return 1;
        if (agrees(sign_of_high, -1)) return -1;
        if (i > 0 && !agrees(sign_relative_to_x((*this)[i - 1].high), -1)) return std::nullopt;
        if (i + 1 < count && !agrees(sign_relative_to_x((*this)[i + 1].low), 1)) return std::nullopt;
        const auto sign = sign_at_x(), sign_at_low = known_sign(simple.at(low));
        if (!sign || !sign_at_low) return std::nullopt;
        return *sign * *sign_at_low;
    }
    [[nodiscard]] std::optional<int> order(int i, const E& x) const {
        return order(
            i, [&x](const E& p) { return known_sign(E(p - x)); }, [&] { return known_sign(simple.at(x)); });
    }
};

namespace detail {

/// Approximates the roots within ±bound of a polynomial in double. Substitutes y = x/bound and divides by the leading
/// coefficient. The coefficients then fit a double, unless the line is so far away that f has no root.
template <class E>
ApproximateRoots<E> approximate_in_double(const Polynomial<E>& f, const E& bound) {
    Polynomial<double> in_double{{}, f.degree};
    E power(1);
    for (int i = f.degree; i >= 0; --i) {
        in_double.coefficient(i) = nearest_double(f.coefficient(i) / (f.leading() * power));
        power = power * bound;
    }
    const ApproximateRoots<double> approximations = approximate_roots(in_double, 1.0);
    ApproximateRoots<E> roots;
    for (int i = 0; i < approximations.count; ++i) roots.add(middle(E(approximations.x[i]) * bound));
    return roots;
}

/// Improves approximations with `bits` correct bits by Newton steps, each of which doubles the number of correct bits.
template <class E>
ApproximateRoots<E> refine(const Polynomial<E>& f, const ApproximateRoots<E>& start, long bits) {
    ApproximateRoots<E> roots = start;
    const Polynomial<E> slope = f.derivative();
    for (const long full_bits = precision_of(E(0)); bits < full_bits; bits *= 2) {
        const typename E::Precision precision(std::min(2 * bits, full_bits));
        for (int i = 0; i < roots.count; ++i) {
            E& x = roots.x[i];
            const E step = middle(f.at(x)) / middle(slope.at(x));
            if (step.is_bounded()) x = middle(x - step);
        }
    }
    return roots;
}

/// Precision of the second search for roots, which runs if the roots found in double prove nothing.
inline constexpr long search_bits = 192;

/// Approximates the roots with `search_bits` bits.
template <class E>
ApproximateRoots<E> approximate_in_search_bits(const Polynomial<E>& f, const E& bound) {
    const typename E::Precision precision(search_bits);
    Polynomial<E> rounded_f{{}, f.degree};
    for (int i = 0; i <= f.degree; ++i) rounded_f.coefficient(i) = middle(f.coefficient(i));
    return approximate_roots(rounded_f, E(middle(bound)));
}

/// Approximates the roots of a polynomial over balls in double, which is accurate enough for most polynomials.
template <class E>
ApproximateRoots<E> approximate_by_first_words(const Polynomial<E>& f, const E& bound) {
    Polynomial<double> in_double{{}, f.degree};
    for (int i = 0; i <= f.degree; ++i) in_double.coefficient(i) = f.coefficient(i).hi();
    const ApproximateRoots<double> approximations = approximate_roots(in_double, bound.hi());
    ApproximateRoots<E> roots;
    for (int i = 0; i < approximations.count; ++i) roots.add(E(approximations.x[i]));
    return roots;
}

/// Encloses a root near an approximation x. The interval extends to eight times the largest possible Newton step, where
/// f is known to differ from 0. If x is itself a root, the interval extends to bound·2^(−half of the bits), and the
/// root is known without error.
template <class E>
EnclosedRoot<E> enclose_root(const Polynomial<E>& f, const Polynomial<E>& slope, E x, const E& bound) {
    for (int i = 0; i < 2; ++i) {
        const E step = f.at(x) / middle(slope.at(x));
        if (step.is_bounded()) x = middle(x - step);
    }
    const E value = f.at(x);
    const bool is_root = known_sign(value) == 0;
    E distance = is_root ? bound : largest_magnitude(value) / largest_magnitude(middle(slope.at(x))) * E(8);
    for (int i = 0; is_root && i < precision_of(x) / 2; ++i) distance = distance / E(2);
    const E low = middle(x - distance), high = middle(x + distance);
    return {low, high, is_root ? x : enclose_between(low, high), true, 1};
}

/// Encloses the roots near their approximations. Each root is proved to lie between two points.
template <class E>
std::optional<EnclosedRoots<E>> enclose_roots_near(const ApproximateRoots<E>& approximations, EnclosedRoots<E> roots,
                                                   bool are_simple, const E& bound) {
    if (approximations.count != roots.count) return std::nullopt;
    const Polynomial<E> slope = roots.simple.derivative();
    for (int i = 0; i < roots.count; ++i) {
        EnclosedRoot<E>& root = roots.all[i];
        root = enclose_root(roots.simple, slope, approximations.x[i], bound);
        const auto sign_before = known_sign(roots.simple.at(root.low)),
                   sign_after = known_sign(roots.simple.at(root.high));
        if (!sign_before || !sign_after || *sign_before * *sign_after >= 0) return std::nullopt;
        if (i > 0 && known_sign(E(root.low - roots[i - 1].high)) != 1) return std::nullopt;
    }

    // The sign beyond the last root is that of the leading coefficient. Close to a double root f is tiny and its sign
    // may be unknown. So the sign is taken half way between two roots.
    for (int i = roots.count - 1, sign = known_sign(roots.f.leading()).value_or(1); i >= 0; --i) {
        EnclosedRoot<E>& root = roots.all[i];
        root.sign_beyond = sign;
        const bool is_first = i == 0;
        const auto sign_before = are_simple ? std::optional(-sign)
                                 : is_first ? known_sign(roots.f.at(middle(-bound)))
                                            : known_sign(roots.f.at(middle((roots[i - 1].high + root.low) / E(2))));
        if (!sign_before) return std::nullopt;
        sign = *sign_before;
        root.changes_sign = sign != root.sign_beyond;
    }
    return roots;
}

}  // namespace detail

/// Encloses all real roots of a polynomial, which must lie within ±bound. Their number follows from Sturm's theorem.
/// Each root lies between two points, and no two intervals hold the same root: f divided by its common divisor with its
/// slope has different signs at the ends of each interval. Returns nothing if the approximations are not close enough
/// to prove that. f must have no cubic term.
template <class E>
std::optional<EnclosedRoots<E>> enclose_roots(const Polynomial<E>& f, const E& bound) {
    const auto counted = count_roots(f);
    if (!counted) return std::nullopt;
    EnclosedRoots<E> roots{f, f, {}, counted->count};
    if (roots.count == 0) return roots;
    const bool are_simple = counted->common_divisor.degree == 0;
    if (!are_simple) {
        roots.simple = divide(f, counted->common_divisor).quotient;
        if (!trim(roots.simple)) return std::nullopt;
    }

    // Tries approximations from the cheapest to the most precise.
    const E search_bound = middle(bound);
    const auto enclose_near = [&](const ApproximateRoots<E>& approximations) {
        return detail::enclose_roots_near(approximations, roots, are_simple, bound);
    };
    if constexpr (requires { bound.hi(); }) {
        return enclose_near(detail::approximate_by_first_words(roots.simple, search_bound));
    } else if constexpr (requires { typename E::Precision; }) {
        if (auto enclosed = enclose_near(
                detail::refine(roots.simple, detail::approximate_in_double(roots.simple, search_bound), 53)))
            return enclosed;
        if (auto enclosed = enclose_near(detail::refine(
                roots.simple, detail::approximate_in_search_bits(roots.simple, search_bound), detail::search_bits)))
            return enclosed;
        return enclose_near(approximate_roots(roots.simple, search_bound));
    } else {
        return enclose_near(approximate_roots(roots.simple, search_bound));
    }
}

}  // namespace lostbits
