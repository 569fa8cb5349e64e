// Rays, and the answers of forms about rays, over any number.
#pragma once

#include "geometry/vec.hpp"

namespace lostbits {

/// R(t) = origin + t·direction. The direction has any length but zero; t is in units of that length.
template <class T>
struct Ray {
    Vec<T> origin;
    Vec<T> direction;
};

/// A form's answer. `hit` is the form's own decision for "there is an intersection with t ≥ 0"; `t` is the first such
/// intersection. If the form yields both intersections (its `Info` says so), `near ≤ far` are their line parameters. If
/// `hit` is false, the numbers have no meaning.
template <class T>
struct Hit {
    mask_t<T> hit;
    T t;
    T near;
    T far;
};

/// The answer of a form that finds one intersection: near = far = t. It takes its arguments by value: with references,
/// GCC 12 writes three unused registers to the stack for each pack, which costs up to a tenth of the time at 512 bits.
template <class T>
Hit<T> single_hit(mask_t<T> hit, T t) {
    return {hit, t, t, t};
}

}  // namespace lostbits
