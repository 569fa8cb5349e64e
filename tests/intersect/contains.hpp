// Whether what an enclosure says of a number is true of 2048 bits.
#pragma once

#include "intersect/exact.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"

namespace lostbits::test {

// The 2048-bit value stands for the exact one; what it may be off by, relative to its size and to that of the ray.
inline const Wide slack = ldexp(Wide(1), -1500);

inline bool contains(const Interval& x, const Wide& v) {
    const mpfr_srcptr p = v.backend().data();
    if (mpfr_nan_p(p) != 0) return x.undefined() != Undefined::never;
    if (mpfr_inf_p(p) != 0) return !x.is_bounded();
    const Wide room = (abs(v) + 1) * slack;
    return x.undefined() != Undefined::always && mpfr_cmp(x.lower(), Wide(v + room).backend().data()) <= 0 &&
           mpfr_cmp(x.upper(), Wide(v - room).backend().data()) >= 0;
}

inline bool contains(const Ball& x, const Wide& v) {
    const mpfr_srcptr p = v.backend().data();
    if (mpfr_nan_p(p) != 0) return x.undefined() != Undefined::never;
    if (mpfr_inf_p(p) != 0) return !x.is_bounded();
    return x.undefined() != Undefined::always &&
           abs(v - Wide(x.hi()) - Wide(x.lo())) <= Wide(x.radius()) + (abs(v) + 1) * slack;
}

}  // namespace lostbits::test
