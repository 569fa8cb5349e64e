// Function that several tube forms share: it finds the first root ahead that lies between the ends.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/tube/tube.hpp"

namespace lostbits::intersect::tube {

/// Finds the first root t ≥ 0 whose position along the axis, `axis_start` + t `axis_rate`, is between 0 and `height`.
/// If the near root is behind the origin or beyond an end, the far root may count. A NaN is not a root.
template <Number T>
Hit<T> find_first_between_ends(const mask_t<T>& is_miss, const RootPair<T>& roots, const T& axis_start,
                               const T& axis_rate, const T& height) {
    const auto is_between_ends = [&](const T& t) {
        const T y = axis_start + t * axis_rate;
        return t >= T(0) && y >= T(0) && y <= height;
    };
    const auto is_near_hit = is_between_ends(roots.near);
    const T t = named("t", select(is_near_hit, roots.near, roots.far));
    return {!is_miss && (is_near_hit || is_between_ends(roots.far)), t, t, t};
}

}  // namespace lostbits::intersect::tube
