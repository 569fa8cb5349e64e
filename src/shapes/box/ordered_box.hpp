// A box for kernels with one ray and many boxes.
#pragma once

#include "geometry/vec.hpp"

namespace lostbits {

/// A box whose planes are in the order in which the line meets them, from a kernel that knows the signs of the
/// direction.
template <class T>
struct OrderedBox {
    Vec<T> first;
    Vec<T> second;
};

}  // namespace lostbits
