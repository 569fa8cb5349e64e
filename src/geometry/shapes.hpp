// What is intersected with what, over any number.
#pragma once

#include "geometry/vec.hpp"

namespace lostbits {

/// R(t) = origin + t·direction. The direction has any length but zero; t is in units of that length.
template <class T>
struct Ray {
    Vec<T> origin;
    Vec<T> direction;
};

/// All points at distance `radius` > 0 from `centre`.
template <class T>
struct Sphere {
    Vec<T> centre;
    T radius;
};

/// All points p with lo ≤ p ≤ hi in each component: closed, axis-aligned. A side may have zero thickness (lo = hi).
template <class T>
struct Box {
    Vec<T> lo;
    Vec<T> hi;
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
