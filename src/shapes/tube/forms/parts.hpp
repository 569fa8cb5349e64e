// What several tube forms share: the first root ahead that lies between the ends.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/tube/tube.hpp"

namespace lostbits::intersect::tube {

/// The place of a root along the axis is `low` + t `across`, between 0 and `height`; the far root counts where the near
/// one is beyond an end or behind. A NaN is no root.
template <Number T>
Hit<T> first_between_ends(const mask_t<T>& missed, const RootPair<T>& roots, const T& low, const T& across,
                          const T& height) {
    const auto counts = [&](const T& t) {
        const T y = low + t * across;
        return t >= T(0) && y >= T(0) && y <= height;
    };
    const auto near = counts(roots.near);
    const T t = named("t", select(near, roots.near, roots.far));
    return {!missed && (near || counts(roots.far)), t, t, t};
}

}  // namespace lostbits::intersect::tube
