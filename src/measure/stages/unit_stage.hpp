// Directions of length one, each component correctly rounded.
#pragma once

#include "measure/stages/binary32.hpp"
#include "measure/stages/problem.hpp"

namespace lostbits::measure::stages {

/// A direction's components, rounded; nothing unless `settled`.
template <class P>
struct UnitDirection {
    mask_t<P> settled;
    P components[3];
};

/// The lemma, ε = 2^-102 (`word_error`), for components that are 0 or within [2^-200, 2^200]: their squares are exact,
/// the two sums add 2ε of d·d, the root ε and half of that, the quotient ε:
///     |q̂ − d_i/|d|| ≤ 4ε |q̂|
/// In binary64 hi is nearest to d_i/|d| if it is nearest to hi + (lo ± 8ε|hi|). In binary32 the float nearest to
/// hi ± 2^-50|hi| is, if both have the same: 2^-53 + 4ε < 2^-51. Quotients below 2^-120 are left, for a float of them
/// may be subnormal. What `scale` multiplies is 8ε and 2^-50.
template <class P>
UnitDirection<P> settle_unit_direction(const P (&d)[3], bool binary32, const P& scale) {
    using lostbits::abs;
    const P zero(0);
    const TwoWords<P> a = sum_of_three(product_of<P>(d[0], d[0]), product_of<P>(d[1], d[1]), product_of<P>(d[2], d[2]));
    const TwoWords<P> length = sqrt(a);
    UnitDirection<P> unit{length.hi > zero, {}};
    for (int i = 0; i < 3; ++i) {
        const P size = abs(d[i]);
        const auto none = size <= zero;
        const TwoWords<P> q = TwoWords<P>{d[i], zero} / length;
        const P slack = abs(q.hi) * (P(8 * word_error) * scale), wide = abs(q.hi) * (P(0x1p-50) * scale);
        const P below = binary32 ? nearest_binary32(q.hi - wide) : q.hi + (q.lo - slack);
        const P above = binary32 ? nearest_binary32(q.hi + wide) : q.hi + (q.lo + slack);
        unit.components[i] = select(none, d[i], above);  // keeps the sign of a zero
        unit.settled = unit.settled && (none || (below <= above && below >= above && size >= P(least_length) &&
                                                 size <= P(largest_length) && abs(q.hi) >= P(0x1p-120)));
    }
    return unit;
}

}  // namespace lostbits::measure::stages
