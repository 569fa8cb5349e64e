// Real roots of a polynomial of degree at most four: approximated in any arithmetic, and enclosed with a proof.
#pragma once

#include <algorithm>

#include "geometry/polynomial.hpp"

namespace lostbits {

inline double middle(double x) { return x; }
inline int precision_of(double) { return 53; }

/// At most four numbers in ascending order.
template <class T>
struct NearRoots {
    std::array<T, 4> x;
    int count = 0;

    void add(const T& root) { x[static_cast<std::size_t>(count++)] = root; }
};

/// Finds the sign change of f between two numbers by Newton's method; bisects if a Newton step leaves the interval.
template <class A>
A near_root(const Polynomial<A>& f, A low, A high) {
    const Polynomial<A> slope = f.slope();
    const bool rises = known_sign(middle(f.at(low))) == -1;
    const A half = A(1) / A(2);
    A x = middle(half * (low + high));
    for (int i = 0; i < 4 * precision_of(x); ++i) {
        const A value = middle(f.at(x));
        const auto sign = known_sign(value);
        if (!sign || *sign == 0) break;
        (rises == (*sign < 0) ? low : high) = x;
        const A steep = middle(slope.at(x));
        A next = known_sign(steep) == 0 ? x : middle(x - value / steep);
        const bool between = known_sign(A(next - low)) == 1 && known_sign(A(high - next)) == 1;
        if (!between) next = middle(half * (low + high));
        if (known_sign(A(next - x)) == 0 || known_sign(A(next - low)) == 0 || known_sign(A(high - next)) == 0)
            return next;
        x = next;
    }
    return x;
}

/// Approximates the roots within ±bound at which f changes sign. They lie between neighbouring such roots of its slope:
/// one between two neighbours, or none.
template <class A>
NearRoots<A> near_roots(const Polynomial<A>& f, const A& bound) {
    NearRoots<A> turns, roots;
    if (f.degree > 1) turns = near_roots(f.slope(), bound);
    if (f.degree < 1) return roots;
    A low = -bound;
    auto before = known_sign(middle(f.at(low)));
    for (int i = 0; i <= turns.count; ++i) {
        const A high = i < turns.count ? turns.x[static_cast<std::size_t>(i)] : bound;
        const auto after = known_sign(middle(f.at(high)));
        if (before && after && *before * *after < 0) roots.add(near_root(f, low, high));
        if (after != 0) low = high, before = after;
    }
    return roots;
}

/// An interval that holds exactly one root. `crosses` says whether the polynomial changes sign at the root; `behind` is
/// its sign behind it.
template <class E>
struct EnclosedRoot {
    E low, high, root;
    bool crosses;
    int behind;
};

/// All real roots of f in order, and a polynomial that has each of them once.
template <class E>
struct EnclosedRoots {
    Polynomial<E> f, simple;
    std::array<EnclosedRoot<E>, 4> all;
    int count = 0;

    [[nodiscard]] const EnclosedRoot<E>& operator[](int i) const { return all[static_cast<std::size_t>(i)]; }
    /// Compares root i with a point x: −1 below, 0 at, +1 above it; nothing if that is not known. `against(p)` is the
    /// sign of p − x. `value` is the sign of `simple` at x: between the neighbouring roots it changes only at root i.
    template <class Against, class Value>
    [[nodiscard]] std::optional<int> order(int i, const Against& against, const Value& value) const {
        const auto is = [](const std::optional<int>& sign, int wanted) { return sign && *sign * wanted >= 0; };
        const auto& [low, high, root, crosses, behind] = (*this)[i];
        const auto from_low = against(low), from_high = against(high);
        if (is(from_low, 1)) return 1;
        if (is(from_high, -1)) return -1;
        if (i > 0 && !is(against((*this)[i - 1].high), -1)) return std::nullopt;
        if (i + 1 < count && !is(against((*this)[i + 1].low), 1)) return std::nullopt;
        const auto here = value(), before = known_sign(simple.at(low));
        if (!here || !before) return std::nullopt;
        return *here * *before;
    }
    [[nodiscard]] std::optional<int> order(int i, const E& x) const {
        return order(
            i, [&x](const E& p) { return known_sign(E(p - x)); }, [&] { return known_sign(simple.at(x)); });
    }
};

namespace detail {

/// Approximates the roots within ±bound of a polynomial in double. With y = x/bound, the coefficients divided by the
/// leading one fit into the range of double, except for lines so far away that f has no root.
template <class E>
NearRoots<E> near_in_double(const Polynomial<E>& f, const E& bound) {
    Polynomial<double> quick{{}, f.degree};
    E power(1);
    for (int i = f.degree; i >= 0; --i) {
        quick.of(i) = nearest_double(f.of(i) / (f.leading() * power));
        power = power * bound;
    }
    const NearRoots<double> near = near_roots(quick, 1.0);
    NearRoots<E> roots;
    for (int i = 0; i < near.count; ++i) roots.add(middle(E(near.x[static_cast<std::size_t>(i)]) * bound));
    return roots;
}

/// Approximates the roots in a few bits; each Newton step then doubles the number of correct bits.
template <class E>
NearRoots<E> refined(const Polynomial<E>& f, const NearRoots<E>& from, long bits) {
    NearRoots<E> roots = from;
    const Polynomial<E> slope = f.slope();
    for (const long all = precision_of(E(0)); bits < all; bits *= 2) {
        const typename E::Precision more(std::min(2 * bits, all));
        for (int i = 0; i < roots.count; ++i) {
            E& x = roots.x[static_cast<std::size_t>(i)];
            const E step = middle(f.at(x)) / middle(slope.at(x));
            if (step.is_bounded()) x = middle(x - step);
        }
    }
    return roots;
}

/// Precision in which roots are searched if those found in double prove nothing.
inline constexpr long bits_of_search = 192;

/// Approximates the roots in `bits_of_search`.
template <class E>
NearRoots<E> near_in_few_bits(const Polynomial<E>& f, const E& bound) {
    const typename E::Precision few(bits_of_search);
    Polynomial<E> short_f{{}, f.degree};
    for (int i = 0; i <= f.degree; ++i) short_f.of(i) = middle(f.of(i));
    return near_roots(short_f, E(middle(bound)));
}

/// Approximates the roots of a polynomial over balls in double, which is a good enough start for most.
template <class E>
NearRoots<E> near_first_words(const Polynomial<E>& f, const E& bound) {
    Polynomial<double> quick{{}, f.degree};
    for (int i = 0; i <= f.degree; ++i) quick.of(i) = f.of(i).hi();
    const NearRoots<double> near = near_roots(quick, bound.hi());
    NearRoots<E> roots;
    for (int i = 0; i < near.count; ++i) roots.add(E(near.x[static_cast<std::size_t>(i)]));
    return roots;
}

/// Encloses a root near an approximation. The interval extends to eight times the largest possible Newton step, where f
/// is known to differ from 0. If the approximation is itself a root, it extends to bound·2^(−half of the bits), and the
/// root is known without error.
template <class E>
EnclosedRoot<E> around(const Polynomial<E>& f, const Polynomial<E>& slope, E x, const E& bound) {
    for (int i = 0; i < 2; ++i) {
        const E step = f.at(x) / middle(slope.at(x));
        if (step.is_bounded()) x = middle(x - step);
    }
    const E value = f.at(x);
    const bool exact = known_sign(value) == 0;
    E away = exact ? bound : largest(value) / largest(middle(slope.at(x))) * E(8);
    for (int i = 0; exact && i < precision_of(x) / 2; ++i) away = away / E(2);
    const E low = middle(x - away), high = middle(x + away);
    return {low, high, exact ? x : between(low, high), true, 1};
}

/// Encloses the roots near their approximations; each is proved to lie between two points.
template <class E>
std::optional<EnclosedRoots<E>> enclosed_from(const NearRoots<E>& near, EnclosedRoots<E> roots, bool are_simple,
                                              const E& bound) {
    if (near.count != roots.count) return std::nullopt;
    const Polynomial<E> slope = roots.simple.slope();
    for (int i = 0; i < roots.count; ++i) {
        EnclosedRoot<E>& root = roots.all[static_cast<std::size_t>(i)];
        root = around(roots.simple, slope, near.x[static_cast<std::size_t>(i)], bound);
        const auto before = known_sign(roots.simple.at(root.low)), behind = known_sign(roots.simple.at(root.high));
        if (!before || !behind || *before * *behind >= 0) return std::nullopt;
        if (i > 0 && known_sign(E(root.low - roots[i - 1].high)) != 1) return std::nullopt;
    }
    // The sign behind the last root is that of the leading coefficient. Half way to the next root the sign is known,
    // even if the sign of f beside a double root, the square of a small number, is not.
    for (int i = roots.count - 1, sign = known_sign(roots.f.leading()).value_or(1); i >= 0; --i) {
        EnclosedRoot<E>& root = roots.all[static_cast<std::size_t>(i)];
        root.behind = sign;
        const bool first = i == 0;
        const auto before = are_simple ? std::optional(-sign)
                            : first    ? known_sign(roots.f.at(middle(-bound)))
                                       : known_sign(roots.f.at(middle((roots[i - 1].high + root.low) / E(2))));
        if (!before) return std::nullopt;
        sign = *before;
        root.crosses = sign != root.behind;
    }
    return roots;
}

}  // namespace detail

/// Encloses all real roots of a polynomial; they must lie within ±bound. Their number follows from Sturm's theorem.
/// Each lies between two points, and no two intervals hold the same root: f divided by its common divisor with its
/// slope changes sign in each. Nothing if these numbers are not close enough to prove that. f must have no cubic term.
template <class E>
std::optional<EnclosedRoots<E>> enclosed_roots(const Polynomial<E>& f, const E& bound) {
    const auto counted = count_roots(f);
    if (!counted) return std::nullopt;
    EnclosedRoots<E> roots{f, f, {}, counted->count};
    if (roots.count == 0) return roots;
    const bool are_simple = counted->repeated.degree == 0;
    if (!are_simple) {
        roots.simple = divide(f, counted->repeated).quotient;
        if (!trim(roots.simple)) return std::nullopt;
    }
    const E end = middle(bound);
    const auto from = [&](const NearRoots<E>& near) { return detail::enclosed_from(near, roots, are_simple, bound); };
    if constexpr (requires { bound.hi(); }) {
        return from(detail::near_first_words(roots.simple, end));
    } else if constexpr (requires { typename E::Precision; }) {
        if (auto found = from(detail::refined(roots.simple, detail::near_in_double(roots.simple, end), 53)))
            return found;
        if (auto found = from(
                detail::refined(roots.simple, detail::near_in_few_bits(roots.simple, end), detail::bits_of_search)))
            return found;
        return from(near_roots(roots.simple, end));
    } else {
        return from(near_roots(roots.simple, end));
    }
}

}  // namespace lostbits
