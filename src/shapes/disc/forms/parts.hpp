// What several disc forms share.
#pragma once

#include "geometry/ray.hpp"
#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "shapes/disc/disc.hpp"

namespace lostbits::intersect::disc {

/// The answer of a form that finds one t, and the square of how far from the centre that is. A NaN is no hit.
template <Number T>
Hit<T> met_at_rim(const T& t, const T& distance2, const Disc<T>& disc) {
    const auto inside = distance2 <= square(disc.outer_radius) && distance2 >= square(disc.inner_radius);
    return {inside && t >= T(0), t, t, t};
}

}  // namespace lostbits::intersect::disc
