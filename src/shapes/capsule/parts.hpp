// Splits a capsule into the primitives whose union it is.
#pragma once

#include "shapes/capsule/capsule.hpp"
#include "shapes/cylinder/cylinder.hpp"

namespace lostbits {

/// Calls `act` on the cylinder between the ends of a capsule, and on the balls at both ends.
template <class T, class Act>
void for_each_part(const Capsule<T>& capsule, const Act& act) {
    act(Cylinder<T>{capsule.start, capsule.end, capsule.radius});
    act(Sphere<T>{capsule.start, capsule.radius});
    act(Sphere<T>{capsule.end, capsule.radius});
}

}  // namespace lostbits
