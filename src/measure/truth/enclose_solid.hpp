// The exact answer for any solid.
#pragma once

#include "measure/truth/enclose_box.hpp"

namespace lostbits::measure::truth {

/// The closed solid, whatever its shape. `tmax` (null: nowhere) ends the ray for boxes; a sphere's problem has no end.
/// `at_origin` is asked of spheres.
template <class E>
Enclosed<E> enclose(const Ray<E>& ray, const Solid<E>& solid, const E* tmax = nullptr,
                    intersect::AtOrigin at_origin = intersect::AtOrigin::hit) {
    return solid.shape == Shape::sphere ? enclose(ray, solid.sphere(), at_origin)
                                        : enclose(ray, solid.box(), tmax, intersect::Touching::hit);
}

}  // namespace lostbits::measure::truth
