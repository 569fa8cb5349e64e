// Function that several disc forms share.
#pragma once

#include "geometry/ray.hpp"
#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "shapes/disc/disc.hpp"

namespace lostbits::intersect::disc {

/// Returns the answer of a form that finds one t. `distance2` is the squared distance of the point at t from the
/// centre. A NaN is not a hit.
template <Number T>
Hit<T> hit_between_rims(const T& t, const T& distance2, const Disc<T>& disc) {
    const auto is_between = distance2 <= square(disc.outer_radius) && distance2 >= square(disc.inner_radius);
    return {is_between && t >= T(0), t, t, t};
}

}  // namespace lostbits::intersect::disc
