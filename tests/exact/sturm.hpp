// The real roots of an equation of degree four, counted: as enclosed numbers, or without an error.
#pragma once

#include <array>
#include <cstddef>

#include "exact/roots.hpp"

namespace lostbits::exact {

/// c[0] + c[1] x + … + c[degree] x^degree.
template <class E>
struct Powers {
    std::array<E, 5> c;
    std::size_t degree = 0;

    [[nodiscard]] const E& leading() const { return c[degree]; }
    [[nodiscard]] E at(const E& x) const {
        E value = c[degree];
        for (std::size_t i = degree; i-- > 0;) value = value * x + c[i];
        return value;
    }
    [[nodiscard]] Powers slope() const {
        Powers s;
        s.degree = degree - 1;
        for (std::size_t i = 0; i < degree; ++i) s.c[i] = E(static_cast<double>(i + 1)) * c[i + 1];
        return s;
    }
    /// Sign of f just behind x: the sign of the first of f and its derivatives that is not 0 at x.
    [[nodiscard]] int sign_behind(const E& x) const {
        const int here = sign(at(x));
        return here != 0 || degree == 0 ? here : slope().sign_behind(x);
    }
    /// Removes leading zeros; returns true if a coefficient is left.
    [[nodiscard]] bool strip() {
        while (degree > 0 && sign(leading()) == 0) --degree;
        return sign(leading()) != 0;
    }
};

/// Remainder of f divided by g, times a positive number.
template <class E>
Powers<E> rest(Powers<E> f, const Powers<E>& g) {
    const bool falls = sign(g.leading()) < 0;
    for (;; --f.degree) {
        const E k = falls ? -f.leading() : f.leading(), m = falls ? -g.leading() : g.leading();
        for (std::size_t i = 0; i < f.degree; ++i) f.c[i] = m * f.c[i];
        const std::size_t up = f.degree - g.degree;
        for (std::size_t i = 0; i < g.degree; ++i) f.c[i + up] = f.c[i + up] - k * g.c[i];
        if (up == 0) break;
    }
    f.degree = g.degree - 1;
    return f;
}

/// Sturm's theorem: the chain is f, its derivative, and then each time the negated remainder of the two before. If f(x)
/// ≠ 0, the number of sign changes at x is the number of different real roots behind x, plus a constant for the complex
/// roots.
template <class E>
class Sturm {
public:
    /// f of degree four, in the variable t − origin.
    Sturm(const Powers<E>& f, const E& origin) : origin_(origin), chain_{f, f.slope()} {
        while (chain_[length_ - 1].degree > 0) {
            Powers<E> next = rest(chain_[length_ - 2], chain_[length_ - 1]);
            if (!next.strip()) break;
            for (std::size_t i = 0; i <= next.degree; ++i) next.c[i] = -next.c[i];
            chain_[length_++] = next;
        }
        most_ = changes([](const Powers<E>& g) { return g.degree % 2 == 0 ? sign(g.leading()) : -sign(g.leading()); });
    }
    /// Number of roots.
    [[nodiscard]] int all() const {
        return most_ - changes([](const Powers<E>& g) { return sign(g.leading()); });
    }
    /// Number of roots that are at most t.
    [[nodiscard]] int up_to(const E& t) const {
        return most_ - changes([x = t - origin_](const Powers<E>& g) { return g.sign_behind(x); });
    }
    [[nodiscard]] bool is_root(const E& t) const { return sign(chain_[0].at(t - origin_)) == 0; }

private:
    template <class SignOf>
    [[nodiscard]] int changes(const SignOf& sign_of) const {
        int count = 0, before = 0;
        for (std::size_t i = 0; i < length_; ++i) {
            const int now = sign_of(chain_[i]);
            count += now * before < 0 ? 1 : 0;
            if (now != 0) before = now;
        }
        return count;
    }

    E origin_;
    std::array<Powers<E>, 5> chain_;
    std::size_t length_ = 2;
    int most_ = 0;
};

/// One of the roots, counted from 1.
template <class E>
struct RootOf {
    Sturm<E> sturm;
    int index;
};

template <class E>
int order(const RootOf<E>& a, const Place<E>& b) {
    const E& t = number_of(b);
    const int before = a.sturm.up_to(t);
    if (before < a.index) return 1;
    return before == a.index && a.sturm.is_root(t) ? 0 : -1;
}

}  // namespace lostbits::exact
