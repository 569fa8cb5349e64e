// Shared by several capsule forms: chooses by which of side and balls a line enters and leaves.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/capsule/capsule.hpp"

namespace lostbits::intersect::capsule {

/// The roots of the line with a part of a capsule; `missed` says that it misses the part.
template <Number T>
struct PartHit {
    mask_t<T> missed;
    RootPair<T> roots;
};

/// Chooses by the position of the side's roots along the axis, low + t across. A root between 0 and v² is that of the
/// capsule. Below 0 the ball at the base replaces the side, above v² the ball at the top. A line parallel to the axis
/// (a NaN) takes the balls.
template <Number T>
Hit<T> joined(const PartHit<T>& side, const PartHit<T>& base, const PartHit<T>& top, const T& low, const T& across,
              const T& v2) {
    const T in = named("y_in", low + side.roots.near * across), out = named("y_out", low + side.roots.far * across);
    const mask_t<T> up = across >= T(0);
    const auto chosen = [&](const T& y, const T& of_side, const T& of_base, const T& of_top, const mask_t<T>& usual) {
        const mask_t<T> within = y >= T(0) && y <= v2, below = y<T(0), above = y> v2;
        return select(within, of_side, select(below || (!above && usual), of_base, of_top));
    };
    const T near = named("near", chosen(in, side.roots.near, base.roots.near, top.roots.near, up));
    const T far = named("far", chosen(out, side.roots.far, base.roots.far, top.roots.far, !up));
    return hit_unless<T>(side.missed || !(near <= far), {near, far});
}

}  // namespace lostbits::intersect::capsule
