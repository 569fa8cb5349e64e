// Signs along Sturm's chain of a quartic without a cubic term, and the first root behind a point found by them: for
// packs of rays, and for forms.
#pragma once

#include <array>

#include "geometry/polynomial.hpp"

namespace lostbits {

/// Sturm's chain of f = n x⁴ + p x² + q x + r: f, f′, and the successive remainders, each times −1. With α = 3q/2p and
/// β = 2r/p the remainders are −2p (x² + α x + β), u x − v, and a number. If p or u is 0, the chain decides nothing.
template <class T>
struct QuarticChain {
    using Values = std::array<T, 5>;
    T n, p, q, r, u, v, last;

    QuarticChain(const T& of_x4, const T& of_x2, const T& of_x, const T& rest)
        : QuarticChain(of_x4, of_x2, of_x, rest, T(3) * of_x / (T(2) * of_x2), T(2) * rest / of_x2) {}
    explicit QuarticChain(const Polynomial<T>& f) : QuarticChain(f.c[4], f.c[2], f.c[1], f.c[0]) {}

    [[nodiscard]] T value(const T& x) const { return (n * square(x) + p) * square(x) + (q * x + r); }
    [[nodiscard]] T slope(const T& x) const { return (T(4) * n * square(x) + T(2) * p) * x + q; }
    [[nodiscard]] Values at(const T& x) const {
        return {value(x), slope(x), -(T(2) * p * square(x) + (T(3) * q * x + T(4) * r)), u * x - v, last};
    }
    [[nodiscard]] Values at_infinity() const { return {n, n, -p, u, last}; }

private:
    QuarticChain(const T& of_x4, const T& of_x2, const T& of_x, const T& rest, const T& alpha, const T& beta)
        : n(of_x4),
          p(of_x2),
          q(of_x),
          r(rest),
          u(-(T(4) * n * (square(alpha) - beta) + T(2) * p)),
          v(T(4) * n * alpha * beta + q),
          last(T(2) * p * ((v / u + alpha) * (v / u) + beta)) {}
};

/// Number of sign changes along a chain. The number of roots between two points is the number of changes at the first
/// less that at the second.
template <class T>
T sign_changes(const std::array<T, 5>& chain) {
    T count(0);
    for (std::size_t i = 1; i < chain.size(); ++i) {
        const auto falls = chain[i - 1] > T(0) && chain[i] < T(0), rises = chain[i - 1] < T(0) && chain[i] > T(0);
        count = count + select(falls || rises, T(1), T(0));
    }
    return count;
}

/// Signs of a chain whose numbers, except the last, have bounds: how often they change, whether all are known, and
/// whether the one before the last is positive.
template <class E>
struct Changes {
    typename E::P count;
    mask_t<typename E::P> known, up;
};
template <class E>
Changes<E> changes_in(const std::array<E, 5>& chain) {
    using P = typename E::P;
    const E zero(0);
    auto before = (chain[0] > zero).yes();
    auto known = before || (chain[0] < zero).yes();
    P count(0);
    for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
        const auto now = (chain[i] > zero).yes();
        known = known && (now || (chain[i] < zero).yes());
        count = count + select((now && !before) || (before && !now), P(1), P(0));
        before = now;
    }
    return {count, known, before};
}

/// Proved statements about roots behind one point and not behind another: there are none, or there are some. If the
/// numbers before the last have the same sign at both points, the sign of the last makes no difference, even if it is
/// 0.
template <class P>
struct RootsBetween {
    mask_t<P> none, some;
};
template <class E, class P = typename E::P>
RootsBetween<P> roots_between(const Changes<E>& a, const Changes<E>& b, const E& last) {
    const auto rises = (last > E(0)).yes(), falls = (last < E(0)).yes();
    const auto more = (b.up && !a.up && rises) || (a.up && !b.up && falls), same = (a.up && b.up) || (!a.up && !b.up);
    const auto known = a.known && b.known && (same || rises || falls);
    const P count = a.count - b.count + select(same, P(0), select(more, P(1), P(-1)));
    return {known && count <= P(0), known && count > P(0)};
}

/// True if the first root behind a point with these changes is proved to lie between two numbers: f has different signs
/// at them, no root lies before the lower one, and no double root (where u x − v is 0) lies between them.
template <class E>
mask_t<typename E::P> is_first_between(const QuarticChain<E>& f, const Changes<E>& from, const E& low, const E& high) {
    const E zero(0), behind = f.value(high), bend = f.u * high - f.v;
    const auto at_low = f.at(low);
    const auto turns =
        ((at_low[0] < zero).yes() && (behind > zero).yes()) || ((at_low[0] > zero).yes() && (behind < zero).yes());
    const auto before = changes_in(at_low);
    const auto simple = (f.last > zero).yes() || (f.last < zero).yes() || (before.up && (bend > zero).yes()) ||
                        (!before.up && (bend < zero).yes());
    return turns && simple && roots_between(from, before, f.last).none;
}

/// Approximates the first root behind `begin` by the signs: 24 bisection steps, then Newton steps.
template <class T>
T near_first_root(const QuarticChain<T>& chain, const T& begin, const T& bound, int steps) {
    const T from = sign_changes(chain.at(begin)), half = T(1) / T(2);
    T low = select(begin > -bound, begin, -bound), high = bound;
    for (int i = 0; i < 24; ++i) {
        const T middle = half * (low + high);
        const auto none = sign_changes(chain.at(middle)) >= from;
        low = select(none, middle, low), high = select(none, high, middle);
    }
    // A step that leads further out than this width goes to another root, or consists of rounding errors.
    const T width = high - low, least = low - width, most = high + width;
    T x = half * (low + high);
    for (int i = 0; i < steps; ++i) {
        const T next = x - chain.value(x) / chain.slope(x);
        x = select(least <= next && next <= most, next, x);
    }
    return x;
}

}  // namespace lostbits
