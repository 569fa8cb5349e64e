// Published bounds on rounding errors, for forms and for offsets.
#pragma once

#include "geometry/vec.hpp"

namespace lostbits {

/// γ(n) = n u/(1 − n u), which bounds the relative error of n roundings while n u < 1 (Higham, Accuracy and Stability
/// of Numerical Algorithms, 2002, lemma 3.1). It is computed in T, and is zero in exact arithmetic.
template <Number T>
T gamma_bound(int n) {
    const T nu = T(n) * unit_roundoff<T>();
    return nu / (T(1) - nu);
}

/// A point near a surface, and a bound δ on the error of each of its components.
template <class T>
struct BoundedPoint {
    Vec<T> p, delta;
};

}  // namespace lostbits
