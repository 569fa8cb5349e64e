// Function that several tube forms share: it finds the first root ahead that lies between the ends.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/tube/tube.hpp"

namespace lostbits::intersect::tube {

/// Finds the first root t ≥ 0 whose position along the axis, `low` + t `across`, is between 0 and `height`. If the near
/// root is behind the origin or beyond an end, the far root may count. A NaN is not a root.
template <Number T>
Hit<T> first_between_ends(const mask_t<T>& missed, const RootPair<T>& roots, const T& low, const T& across,
                          const T& height) {
    const auto counts = [&](const T& t) {
        const T y = low + t * across;
        return t >= T(0) && y >= T(0) && y <= height;
    };
    const auto near_counts = counts(roots.near);
    const T t = named("t", select(near_counts, roots.near, roots.far));
    return {!missed && (near_counts || counts(roots.far)), t, t, t};
}

}  // namespace lostbits::intersect::tube
