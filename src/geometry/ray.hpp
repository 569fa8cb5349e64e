// Rays, what they meet, and what is said of that: over any number.
#pragma once

#include "geometry/vec.hpp"

namespace lostbits {

/// R(t) = origin + t·direction. The direction has any length but zero; t is in units of that length.
template <class T>
struct Ray {
    Vec<T> origin;
    Vec<T> direction;
};

/// A form's answer. `hit` is its own decision for "there is an intersection with t ≥ 0", `t` the first such;
/// `near ≤ far` are the line parameters of both intersections where the form yields them (its `Info` says).
/// Where `hit` is false the numbers mean nothing.
template <class T>
struct Hit {
    mask_t<T> hit;
    T t;
    T near;
    T far;
};

}  // namespace lostbits
