// Shared by several disc forms.
#pragma once

#include "geometry/ray.hpp"
#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "shapes/disc/disc.hpp"

namespace lostbits::intersect::disc {

/// The answer of a form that finds one t, from the squared distance of that point from the centre. A NaN is not a hit.
template <Number T>
Hit<T> met_at_rim(const T& t, const T& distance2, const Disc<T>& disc) {
    const auto inside = distance2 <= square(disc.outer_radius) && distance2 >= square(disc.inner_radius);
    return {inside && t >= T(0), t, t, t};
}

}  // namespace lostbits::intersect::disc
