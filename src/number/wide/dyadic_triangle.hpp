// A ray against a triangle in sums of any size: the last step of `triangle.filtered`.
#pragma once

#include <array>

#include "number/wide/dyadic.hpp"

namespace lostbits::number::wide {

/// x·(y × z)
template <class For>
Dyadic<For> triple_product(const std::array<Dyadic<For>, 3>& x, const std::array<Dyadic<For>, 3>& y,
                           const std::array<Dyadic<For>, 3>& z) {
    Dyadic<For> sum;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        sum = sum + x[i] * (y[j] * z[k] - y[k] * z[j]);
    }
    return sum;
}

/// The decision and t for doubles of any size, by the formula of `Triangle::span`. `in` holds origin, direction and the
/// vertices. `out` receives 1 for a hit or −1 for a miss, then t or −1.
template <class For>
[[gnu::noinline]] static void meet_triangle(const std::array<double, 15>& in, std::array<double, 2>& out) {
    using D = Dyadic<For>;
    std::array<D, 3> d, a, b, c, p, q;
    for (std::size_t i = 0; i < 3; ++i) {
        const D o(in[i]), at(in[6 + i]);
        d[i] = D(in[3 + i]);
        a[i] = at - o;
        b[i] = D(in[9 + i]) - o;
        c[i] = D(in[12 + i]) - o;
        p[i] = D(in[9 + i]) - at;
        q[i] = D(in[12 + i]) - at;
    }
    out = {-1, -1};
    const D m = triple_product(d, p, q), k = triple_product(a, p, q);
    const int side = m.sign();
    const auto beside = [&](const D& x) { return x.sign() == -side; };
    if (side == 0 || beside(k) || beside(triple_product(d, b, c)) || beside(triple_product(d, c, a)) ||
        beside(triple_product(d, a, b)))
        return;
    out = {1, abs(k.scaled() / m.scaled()).value()};
}

}  // namespace lostbits::number::wide
