// Tests if three points lie on one line. The vertices of a triangle must not.
#pragma once

#include <cmath>
#include <concepts>

#include "geometry/vec.hpp"
#include "number/wide/dyadic.hpp"

namespace lostbits {

namespace detail {

/// Returns the component of (b − a) × (c − a) on the axis other than j and k, computed in A.
template <class A, class S>
A cross_component(const Vec<S>& a, const Vec<S>& b, const Vec<S>& c, int j, int k) {
    const auto difference_from_a = [&](const Vec<S>& p, int i) { return A(p[i]) - A(a[i]); };
    return difference_from_a(b, j) * difference_from_a(c, k) - difference_from_a(b, k) * difference_from_a(c, j);
}

/// True if arithmetic in double proves that this component is not zero. The error of each product is at most 3.01u of
/// itself and 2^-1074, and the difference adds u. If the sum of their sizes is above 2^-900, 2^-50 of it is more than
/// the whole error.
inline bool is_proved_nonzero(const Vec<double>& a, const Vec<double>& b, const Vec<double>& c, int j, int k) {
    const double x = (b[j] - a[j]) * (c[k] - a[k]), y = (b[k] - a[k]) * (c[j] - a[j]);
    const double size = std::fabs(x) + std::fabs(y);
    return std::fabs(x - y) > 0x1p-50 * size && size > 0x1p-900;
}

}  // namespace detail

/// True if the points lie on one line, or if one of their numbers is NaN. The answer is exact for floats and doubles
/// of any size. Wider numbers use their own arithmetic.
template <class S>
bool are_on_one_line(const Vec<S>& a, const Vec<S>& b, const Vec<S>& c) {
    constexpr int axes[3][2] = {{1, 2}, {2, 0}, {0, 1}};
    for (const Vec<S>* const p : {&a, &b, &c})
        for (int i = 0; i < 3; ++i)
            if (!((*p)[i] == (*p)[i])) return true;
    if constexpr (std::floating_point<S>) {
        const Vec<double> da(a), db(b), dc(c);
        for (const auto& [j, k] : axes)
            if (detail::is_proved_nonzero(da, db, dc, j, k)) return false;
        for (const auto& [j, k] : axes)
            if (detail::cross_component<number::wide::Dyadic<double>>(da, db, dc, j, k).sign() != 0) return false;
    } else {
        for (const auto& [j, k] : axes)
            if (detail::cross_component<S>(a, b, c, j, k) != 0) return false;
    }
    return true;
}

}  // namespace lostbits
