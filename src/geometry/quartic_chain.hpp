// Signs along Sturm's chain of a quartic without a cubic term, and the first root beyond a point, which these signs
// determine. Packs of rays and forms use them.
#pragma once

#include <array>

#include "geometry/polynomial.hpp"

namespace lostbits {

/// Sturm's chain of f = n x⁴ + p x² + q x + r: f, f′, and the successive remainders, each times −1. With α = 3q/2p and
/// β = 2r/p the remainders are −2p (x² + α x + β), u x − v, and a number. If p or u is 0, the chain gives no result.
template <class T>
struct QuarticChain {
    using Values = std::array<T, 5>;
    T n, p, q, r, u, v, last;

    QuarticChain(const T& quartic_term, const T& quadratic_term, const T& linear_term, const T& constant_term)
        : QuarticChain(quartic_term, quadratic_term, linear_term, constant_term,
                       T(3) * linear_term / (T(2) * quadratic_term), T(2) * constant_term / quadratic_term) {}
    explicit QuarticChain(const Polynomial<T>& f) : QuarticChain(f.c[4], f.c[2], f.c[1], f.c[0]) {}

    [[nodiscard]] T value(const T& x) const { return (n * square(x) + p) * square(x) + (q * x + r); }
    [[nodiscard]] T slope(const T& x) const { return (T(4) * n * square(x) + T(2) * p) * x + q; }
    [[nodiscard]] Values at(const T& x) const {
        return {value(x), slope(x), -(T(2) * p * square(x) + (T(3) * q * x + T(4) * r)), u * x - v, last};
    }
    [[nodiscard]] Values at_infinity() const { return {n, n, -p, u, last}; }

private:
    QuarticChain(const T& quartic_term, const T& quadratic_term, const T& linear_term, const T& constant_term,
                 const T& alpha, const T& beta)
        : n(quartic_term),
          p(quadratic_term),
          q(linear_term),
          r(constant_term),
          u(-(T(4) * n * (square(alpha) - beta) + T(2) * p)),
          v(T(4) * n * alpha * beta + q),
          last(T(2) * p * ((v / u + alpha) * (v / u) + beta)) {}
};

/// Counts the sign changes along a chain, zeros left out: +, 0, − is one change. The number of roots between two points
/// is the number of changes at the first point minus the number at the second. A ray along an axis of symmetry of a
/// torus has zeros: half of the chain of n x⁴ + p x² + r is 0 at x = 0.
template <class T>
T count_sign_changes(const std::array<T, 5>& chain) {
    T count(0), sign = chain[0];
    for (std::size_t i = 1; i < chain.size(); ++i) {
        const auto is_positive = chain[i] > T(0), is_negative = chain[i] < T(0);
        count = count + select((sign > T(0) && is_negative) || (sign < T(0) && is_positive), T(1), T(0));
        sign = select(is_positive || is_negative, chain[i], sign);
    }
    return count;
}

/// Signs of a chain of numbers with bounds, without its last number: how often the signs change, whether all signs are
/// known, and whether the last but one of the chain is positive.
template <class E>
struct SignChanges {
    typename E::P count;
    mask_t<typename E::P> are_known, is_penultimate_positive;
};
template <class E>
SignChanges<E> prove_sign_changes(const std::array<E, 5>& chain) {
    using P = typename E::P;
    const E zero(0);
    auto was_positive = (chain[0] > zero).yes();
    auto are_known = was_positive || (chain[0] < zero).yes();
    P count(0);
    for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
        const auto is_positive = (chain[i] > zero).yes();
        are_known = are_known && (is_positive || (chain[i] < zero).yes());
        count = count + select((is_positive && !was_positive) || (was_positive && !is_positive), P(1), P(0));
        was_positive = is_positive;
    }
    return {count, are_known, was_positive};
}

/// Proofs about the roots between two points: that no root exists (`is_absent`), or that some root exists
/// (`is_present`). If the last but one number of the chain has the same sign at both points, the sign of the last
/// number makes no difference, even if that number is 0.
template <class P>
struct RootsBetween {
    mask_t<P> is_absent, is_present;
};
template <class E, class P = typename E::P>
RootsBetween<P> prove_roots_between(const SignChanges<E>& a, const SignChanges<E>& b, const E& last) {
    const auto is_last_positive = (last > E(0)).yes(), is_last_negative = (last < E(0)).yes();
    const auto last_adds_change = (b.is_penultimate_positive && !a.is_penultimate_positive && is_last_positive) ||
                                  (a.is_penultimate_positive && !b.is_penultimate_positive && is_last_negative),
               is_last_irrelevant = (a.is_penultimate_positive && b.is_penultimate_positive) ||
                                    (!a.is_penultimate_positive && !b.is_penultimate_positive);
    const auto are_known = a.are_known && b.are_known && (is_last_irrelevant || is_last_positive || is_last_negative);
    const P count = a.count - b.count + select(is_last_irrelevant, P(0), select(last_adds_change, P(1), P(-1)));
    return {are_known && count <= P(0), are_known && count > P(0)};
}

/// True if the first root beyond a point with `begin_changes` is proved to lie between two numbers: f has different
/// signs at them, no root lies before the lower one, and no double root (where u x − v is 0) lies between them.
template <class E>
mask_t<typename E::P> is_first_between(const QuarticChain<E>& f, const SignChanges<E>& begin_changes, const E& low,
                                       const E& high) {
    const E zero(0), value_at_high = f.value(high), bend = f.u * high - f.v;
    const auto at_low = f.at(low);
    const auto changes_sign = ((at_low[0] < zero).yes() && (value_at_high > zero).yes()) ||
                              ((at_low[0] > zero).yes() && (value_at_high < zero).yes());
    const auto low_changes = prove_sign_changes(at_low);
    const auto is_simple = (f.last > zero).yes() || (f.last < zero).yes() ||
                           (low_changes.is_penultimate_positive && (bend > zero).yes()) ||
                           (!low_changes.is_penultimate_positive && (bend < zero).yes());
    return changes_sign && is_simple && prove_roots_between(begin_changes, low_changes, f.last).is_absent;
}

/// Approximates the first root beyond `begin` by the signs along the chain: 24 bisection steps, then Newton steps.
template <class T>
T approximate_first_root(const QuarticChain<T>& chain, const T& begin, const T& bound, int steps) {
    const T begin_changes = count_sign_changes(chain.at(begin)), half = T(1) / T(2);
    T low = select(begin > -bound, begin, -bound), high = bound;
    for (int i = 0; i < 24; ++i) {
        const T middle = half * (low + high);
        const auto has_no_root = count_sign_changes(chain.at(middle)) >= begin_changes;
        low = select(has_no_root, middle, low);
        high = select(has_no_root, high, middle);
    }
    // A step that leads further out than this width goes to another root, or consists of rounding errors.
    const T width = high - low, lowest = low - width, highest = high + width;
    T x = half * (low + high);
    for (int i = 0; i < steps; ++i) {
        const T next = x - chain.value(x) / chain.slope(x);
        x = select(lowest <= next && next <= highest, next, x);
    }
    return x;
}

}  // namespace lostbits
