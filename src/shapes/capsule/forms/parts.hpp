// Functions that several capsule forms share. They choose the part (side or end ball) through which a line enters and
// leaves.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/capsule/capsule.hpp"

namespace lostbits::intersect::capsule {

/// Roots of a line with a part of a capsule. `is_miss` is true if the line misses the part.
template <Number T>
struct PartRoots {
    mask_t<T> is_miss;
    RootPair<T> roots;
};

/// Chooses each root by the position of the side's root along the axis, v·f + t v·d. Here v is the axis from base to
/// top, f the origin of the ray seen from the base, and d the direction of the ray. A root of the side between 0 and v²
/// is a root of the capsule. Below 0 the root of the ball at the base replaces it, above v² that of the ball at the
/// top. For a line parallel to the axis the position is NaN, and the balls are chosen.
template <Number T>
Hit<T> choose_parts(const PartRoots<T>& side, const PartRoots<T>& base, const PartRoots<T>& top, const T& v_dot_f,
                    const T& v_dot_d, const T& v_dot_v) {
    const T axial_in = named("y_in", v_dot_f + side.roots.near * v_dot_d),
            axial_out = named("y_out", v_dot_f + side.roots.far * v_dot_d);
    const mask_t<T> is_upward = v_dot_d >= T(0);
    const auto choose_root = [&](const T& axial, const T& side_root, const T& base_root, const T& top_root,
                                 const mask_t<T>& is_base_if_parallel) {
        const mask_t<T> is_within = axial >= T(0) && axial <= v_dot_v;
        const mask_t<T> is_below = axial < T(0);
        const mask_t<T> is_above = axial > v_dot_v;
        return select(is_within, side_root,
                      select(is_below || (!is_above && is_base_if_parallel), base_root, top_root));
    };
    const T near = named("near", choose_root(axial_in, side.roots.near, base.roots.near, top.roots.near, is_upward));
    const T far = named("far", choose_root(axial_out, side.roots.far, base.roots.far, top.roots.far, !is_upward));
    return hit_unless<T>(side.is_miss || !(near <= far), {near, far});
}

}  // namespace lostbits::intersect::capsule
