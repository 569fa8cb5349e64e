// Finite changes of a problem, applied and judged exactly: by signs of polynomials, without roots and quotients, in as
// many bits as MPFR needs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <mpfr.h>

#include "measure/truth/textbook.hpp"
#include "number/real.hpp"

namespace lostbits::test::textbook {

/// Runs `act` in numbers of 512 bits or, if MPFR rounds one of these, again in enough bits for products of sums of any
/// doubles. Returns true if all of them were exact.
template <class Act>
bool in_exact_numbers(const Act& act) {
    mpfr_clear_inexflag();
    act(BasicReal<512>());
    if (!mpfr_inexflag_p()) return true;
    mpfr_clear_inexflag();
    act(BasicReal<4608>());
    return !mpfr_inexflag_p();
}

/// The ray is between two planes from t = entry/speed to t = leave/speed, and where speed is 0 if entry ≤ 0 ≤ leave.
template <class N>
struct Slab {
    N entry, leave, speed;
    Slab(const NumbersOf<N>& x, std::size_t k) : entry(x[6 + k] - x[k]), leave(x[9 + k] - x[k]), speed(x[3 + k]) {
        if (speed >= 0) return;
        std::swap(entry, leave);
        entry = -entry, leave = -leave, speed = -speed;
    }
    /// At most 0 if this slab is entered no later than the other is left.
    [[nodiscard]] N against(const Slab& other) const { return entry * other.speed - other.leave * speed; }
};

template <class N>
std::array<Slab<N>, 3> slabs_of(const NumbersOf<N>& x) {
    return {Slab<N>(x, 0), Slab<N>(x, 1), Slab<N>(x, 2)};
}

/// Quantities whose signs decide whether the ray hits the primitive.
template <class N>
std::vector<N> deciding(Shape shape, const NumbersOf<N>& x) {
    if (shape == Shape::sphere) {
        const Quadratic p(x);
        return {p.discriminant(), p.c, p.h};
    }
    if (shape == Shape::triangle) {
        const Crossing p(x);
        return {p.u, p.v, p.w, p.det, p.n};
    }
    std::vector<N> signs;
    const auto slabs = slabs_of(x);
    for (const Slab<N>& a : slabs) {
        signs.insert(signs.end(), {a.entry, a.leave});
        for (const Slab<N>& b : slabs)
            if (&a != &b && a.speed != 0 && b.speed != 0) signs.push_back(a.against(b));
    }
    return signs;
}

/// Residuals that are 0 if t is an answer; for a box, one for each axis along which the ray moves.
template <class N>
std::vector<N> residuals(Shape shape, const NumbersOf<N>& x, const N& t) {
    if (shape != Shape::box) return {residual(shape, x, t, 0)};
    std::vector<N> all;
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (x[3 + axis] != 0) all.push_back(residual(shape, x, t, axis));
    return all;
}

template <class N>
bool line_meets(const std::array<Slab<N>, 3>& slabs) {
    for (const Slab<N>& a : slabs) {
        if (a.speed == 0 && (a.entry > 0 || a.leave < 0)) return false;
        for (const Slab<N>& b : slabs)
            if (a.speed != 0 && b.speed != 0 && a.against(b) > 0) return false;
    }
    return true;
}

/// True if it is a valid problem: a box does not end before it begins.
template <class N>
bool is_problem(Shape shape, const NumbersOf<N>& x) {
    return shape != Shape::box || (x[6] <= x[9] && x[7] <= x[10] && x[8] <= x[11]);
}

template <class N>
bool is_hit(Shape shape, const NumbersOf<N>& x) {
    if (shape == Shape::sphere) {
        const Quadratic p(x);
        return p.c <= 0 || (p.h <= 0 && p.discriminant() >= 0);
    }
    if (shape == Shape::box) {
        const auto slabs = slabs_of(x);
        return line_meets(slabs) && std::ranges::all_of(slabs, [](const auto& slab) { return slab.leave >= 0; });
    }
    const Crossing p(x);
    return p.is_inside() && (p.det > 0 ? p.n >= 0 : p.n <= 0);
}

enum class Side : std::uint8_t { none, before, there, beyond };

template <class N>
Side side_of(const N& beyond) {
    return beyond > 0 ? Side::beyond : beyond == 0 ? Side::there : Side::before;
}

/// Side of t on which the answer lies: for a sphere the near root, or the far one.
template <class N>
Side side_of(Shape shape, const NumbersOf<N>& x, const N& t, bool is_far) {
    if (shape == Shape::sphere) {
        const Quadratic p(x);
        const N q = p.discriminant(), m = -p.h - p.a * t;
        if (q < 0) return Side::none;
        // The root is t + (m ∓ √q)/a, and √q is above |m| where q is above m².
        if (is_far) return m > 0 ? Side::beyond : side_of<N>(q - m * m);
        return m < 0 ? Side::before : side_of<N>(m * m - q);
    }
    if (shape == Shape::box) {
        const auto slabs = slabs_of(x);
        if (!line_meets(slabs)) return Side::none;
        Side last = Side::before;
        for (const Slab<N>& slab : slabs)
            if (slab.speed != 0) last = std::max(last, side_of<N>(slab.entry - t * slab.speed));
        return last;
    }
    const Crossing p(x);
    if (!p.is_inside()) return Side::none;
    const N beyond = p.n - t * p.det;
    return side_of<N>(p.det > 0 ? beyond : N(-beyond));
}

/// For each number of a problem, +1 if it is increased and −1 if it is decreased.
using Way = std::array<signed char, most_of_problem>;

/// A problem, and others in which every number is changed by a fraction of itself.
template <class N>
class Problem {
public:
    Problem(const Ray<double>& ray, const Primitive<double>& primitive)
        : shape(primitive.shape), x(numbers_of<N>(ray, primitive)), count_(6 + primitive.shape_numbers().size()) {
        for (std::size_t i = 0; i < count_; ++i) sizes_[i] = std::fabs(static_cast<double>(x[i]));
    }

    Shape shape;
    NumbersOf<N> x;

    [[nodiscard]] NumbersOf<N> moved(const Way& way, double by) const {
        NumbersOf<N> there = x;
        for (std::size_t i = 0; i < count_; ++i) there[i] += way[i] * step(i, by);
        return there;
    }
    /// For each of the functions, the signs of the changes for which it falls fastest towards 0, found for one number
    /// after the other.
    template <class F>
    [[nodiscard]] std::vector<Way> ways_to_zero(const F& functions, double by) const {
        const std::vector<N> here = functions(x);
        std::vector<Way> ways(here.size());
        for (std::size_t i = 0; i < count_; ++i) {
            if (sizes_[i] == 0) continue;
            NumbersOf<N> aside = x;
            aside[i] += step(i, by);
            const std::vector<N> there = functions(aside);
            for (std::size_t k = 0; k < here.size(); ++k) ways[k][i] = (there[k] > here[k]) == (here[k] > 0) ? -1 : 1;
        }
        return ways;
    }

private:
    /// |x| by, or a last place of a double less, so that moved numbers are short.
    [[nodiscard]] N step(std::size_t i, double by) const {
        int exponent = 0;
        const double fraction = std::frexp(sizes_[i], &exponent);
        return ldexp(N(std::nextafter(fraction * by, 0.0)), exponent);
    }

    std::size_t count_;
    std::array<double, most_of_problem> sizes_{};
};

}  // namespace lostbits::test::textbook
