// Intersects a ray with a triangle in exact sums of any magnitude: the last step of `triangle.filtered`.
#pragma once

#include <array>

#include "number/wide/dyadic.hpp"

namespace lostbits::number::wide {

/// x·(y × z)
template <class Tag>
Dyadic<Tag> triple_product(const std::array<Dyadic<Tag>, 3>& x, const std::array<Dyadic<Tag>, 3>& y,
                           const std::array<Dyadic<Tag>, 3>& z) {
    Dyadic<Tag> sum;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        sum = sum + x[i] * (y[j] * z[k] - y[k] * z[j]);
    }
    return sum;
}

/// Computes the decision and t for doubles of any magnitude, by the formula of `Triangle::span`. `in` holds origin,
/// direction and the vertices. `out` receives 1 for a hit or −1 for a miss, then t or −1.
template <class Tag>
[[gnu::noinline]] static void meet_triangle(const std::array<double, 15>& in, std::array<double, 2>& out) {
    using D = Dyadic<Tag>;
    std::array<D, 3> d, a, b, c, p, q;
    for (std::size_t i = 0; i < 3; ++i) {
        const D o(in[i]), vertex(in[6 + i]);
        d[i] = D(in[3 + i]);
        a[i] = vertex - o;
        b[i] = D(in[9 + i]) - o;
        c[i] = D(in[12 + i]) - o;
        p[i] = D(in[9 + i]) - vertex;
        q[i] = D(in[12 + i]) - vertex;
    }

    out = {-1, -1};
    const D m = triple_product(d, p, q), k = triple_product(a, p, q);
    const int orientation = m.sign();
    const auto is_outside = [&](const D& x) { return x.sign() == -orientation; };
    if (orientation == 0 || is_outside(k) || is_outside(triple_product(d, b, c)) ||
        is_outside(triple_product(d, c, a)) || is_outside(triple_product(d, a, b)))
        return;

    out = {1, abs(k.scaled() / m.scaled()).value()};
}

}  // namespace lostbits::number::wide
