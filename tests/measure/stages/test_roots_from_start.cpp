// Roots of quartics whose coefficients are known to lie in intervals: what is claimed holds for quartics at the ends of
// these intervals. Rays leave most of what the inequalities allow unused; these quartics do not.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/exact.hpp"
#include "measure/seeded.hpp"
#include "measure/stages/start_stage.hpp"

namespace test_roots_from_start {

using namespace lostbits;
using namespace lostbits::test;
using W = number::wide::TwoWords<double>;
using E = number::wide::RunningError<W>;

namespace {

using Coefficients = std::vector<Rational>;  // the lowest one first

Coefficients product(const Coefficients& p, const Coefficients& q) {
    Coefficients all(p.size() + q.size() - 1);
    for (std::size_t i = 0; i < p.size(); ++i)
        for (std::size_t j = 0; j < q.size(); ++j) all[i + j] += p[i] * q[j];
    return all;
}

/// A quartic made of its roots: its first positive one, and a bound of the sizes of all.
struct Quartic {
    Coefficients c;
    double first = HUGE_VAL, length = 0;

    void multiply(double root) {
        c = product(c, {-Rational(root), 1});
        if (root > 0) first = std::min(first, root);
        length = std::max(length, std::fabs(root));
    }
    /// Two roots a ± b i, b > 0.
    void multiply(double a, double b) {
        c = product(c, {Rational(a) * a + Rational(b) * b, Rational(-2) * a, 1});
        length = std::max(length, std::fabs(a) + b);
    }
};

/// Two roots beside each other, or one alone, and others at a few or at many times their distance.
Quartic any_quartic(Seeded& rng) {
    Quartic made{.c = {1}};
    const double near = rng.magnitude(-6, 1), gap = rng.uniform(0, rng.coin() ? 1 : std::ldexp(1.0, -rng.index(40)));
    const auto other = [&] { return near * (rng.coin() ? rng.uniform(-3, 3) : rng.signed_magnitude(-2, 12)); };
    switch (rng.index(3)) {
        case 0: made.multiply(near, near * std::max(gap, 0x1p-60)); break;
        case 1: made.multiply(near), made.multiply(near * (1 + gap)); break;
        default: made.multiply(rng.sign() * near), made.multiply(other());
    }
    const double third = other(), fourth = other();
    if (rng.index(3) == 0) made.multiply(third, std::fabs(fourth) + near * 0x1p-20);
    else made.multiply(third), made.multiply(fourth);
    return made;
}

/// An interval with x at one of its ends, or near it; its radius is at most 9/10 of its midpoint.
E around(Seeded& rng, const Rational& x) {
    const double near = static_cast<double>(x);
    if (x == 0 || rng.coin()) {
        const auto rest = static_cast<double>(x - Rational(near));
        return {W(near, rest), std::fabs(near) * 0x1p-104};
    }
    const int exponent = rng.index(3) == 0 ? 0 : -rng.index(100);
    const double away = std::ldexp(rng.unit(), exponent);
    const double middle = near * (rng.coin() ? 1 + 9 * away : 1 / (1 + 0.4 * away));
    const auto radius = static_cast<double>(abs(Rational(middle) - x));
    return {W(middle), radius * (1 + 0x1p-50)};
}

struct Claims {
    int none = 0, found = 0, wrong = 0;
};

void check_quartic(Seeded& rng, Claims& claims) {
    const Quartic quartic = any_quartic(rng);
    Polynomial<E> g{{}, 4};
    for (std::size_t k = 0; k < 5; ++k) g.c[k] = around(rng, quartic.c[k]);
    const measure::stages::RootsFromStart<double> roots(g, quartic.length);
    const auto found = roots.first();
    if (roots.none()) {
        ++claims.none;
        claims.wrong += quartic.first <= roots.reach();
    }
    if (found.is_found) {
        ++claims.found;
        const auto end = [](const E& x) { return Rational(x.first()) + Rational(x.second()); };
        const Rational first(std::isfinite(quartic.first) ? quartic.first : -1.0);
        claims.wrong += !(end(found.low) <= first && first <= end(found.high));
        claims.wrong += abs(end(found.root) - first) > Rational(found.root.radius());
    }
}

}  // namespace

TEST_CASE("roots from the start: what is claimed holds at the ends of the intervals", "[torus]") {
    const int count = draws(2'000'000, 10);
    Seeded rng(71);
    Claims claims;
    for (int i = 0; i < count; ++i) check_quartic(rng, claims);
    CAPTURE(claims.none, claims.found);
    CHECK(claims.wrong == 0);
    CHECK(claims.none > count / 20);
    CHECK(claims.found > count / 50);
}

}  // namespace test_roots_from_start
