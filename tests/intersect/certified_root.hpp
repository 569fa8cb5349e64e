// A certified t held against an exact answer, whatever the shape.
#pragma once

#include "intersect/exact.hpp"
#include "measure/truth/truth.hpp"

namespace lostbits::test {

inline Rational power_of_two(std::int64_t e) {
    Rational p(1);
    for (std::int64_t i = 0; i < (e < 0 ? -e : e); ++i) p *= 2;
    return e < 0 ? 1 / p : p;
}

/// Whether the first point lies in what the certified number encloses: `right.is_first(t, e)` says whether a t that is
/// off by at most e may be it.
template <class Answer>
bool encloses_first(const measure::truth::Certified& x, const Answer& right) {
    if (x.is_zero()) return right.is_first(0, 0);
    const Rational unit = power_of_two(x.exponent);
    return right.is_first((Rational(x.hi) + Rational(x.lo)) * unit, Rational(x.bound) * unit);
}

template <class T>
Vec<T> lifted(const Vec<double>& v) {
    return Vec<T>(static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z));
}

}  // namespace lostbits::test
