// Functions that several capsule forms share. They choose by which part, the side or a ball, a line enters and leaves.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/capsule/capsule.hpp"

namespace lostbits::intersect::capsule {

/// Roots of a line with a part of a capsule. `missed` is true if the line misses the part.
template <Number T>
struct PartHit {
    mask_t<T> missed;
    RootPair<T> roots;
};

/// Chooses each root by the position of the side's root along the axis, low + t across. A root of the side between 0
/// and v² is a root of the capsule. Below 0 the root of the ball at the base replaces it, above v² that of the ball at
/// the top. For a line parallel to the axis the position is NaN, and the balls are chosen.
template <Number T>
Hit<T> choose_parts(const PartHit<T>& side, const PartHit<T>& base, const PartHit<T>& top, const T& low,
                    const T& across, const T& v2) {
    const T y_in = named("y_in", low + side.roots.near * across), y_out = named("y_out", low + side.roots.far * across);
    const mask_t<T> up = across >= T(0);
    const auto choose_root = [&](const T& y, const T& of_side, const T& of_base, const T& of_top,
                                 const mask_t<T>& if_parallel) {
        const mask_t<T> is_within = y >= T(0) && y <= v2, is_below = y<T(0), is_above = y> v2;
        return select(is_within, of_side, select(is_below || (!is_above && if_parallel), of_base, of_top));
    };
    const T near = named("near", choose_root(y_in, side.roots.near, base.roots.near, top.roots.near, up));
    const T far = named("far", choose_root(y_out, side.roots.far, base.roots.far, top.roots.far, !up));
    return hit_unless<T>(side.missed || !(near <= far), {near, far});
}

}  // namespace lostbits::intersect::capsule
