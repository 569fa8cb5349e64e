// What several capsule forms share: by which of side and balls a line enters and leaves.
#pragma once

#include "intersect/roots.hpp"
#include "shapes/capsule/capsule.hpp"

namespace lostbits::intersect::capsule {

/// Where the line meets a part of a capsule, and whether it misses it.
template <Number T>
struct PartMet {
    mask_t<T> missed;
    RootPair<T> roots;
};

/// With the place along the axis of the side's roots, low + t across: a root between 0 and v² is the capsule's, one
/// below gives way to the ball at the base, one above to that at the top. A line beside the axis (a NaN) takes the
/// balls.
template <Number T>
Hit<T> joined(const PartMet<T>& side, const PartMet<T>& base, const PartMet<T>& top, const T& low, const T& across,
              const T& v2) {
    const T in = named("y_in", low + side.roots.near * across), out = named("y_out", low + side.roots.far * across);
    const mask_t<T> up = across >= T(0);
    const auto chosen = [&](const T& y, const T& of_side, const T& of_base, const T& of_top, const mask_t<T>& usual) {
        const mask_t<T> within = y >= T(0) && y <= v2, below = y<T(0), above = y> v2;
        return select(within, of_side, select(below || (!above && usual), of_base, of_top));
    };
    const T near = named("near", chosen(in, side.roots.near, base.roots.near, top.roots.near, up));
    const T far = named("far", chosen(out, side.roots.far, base.roots.far, top.roots.far, !up));
    return first_hit<T>(side.missed || !(near <= far), {near, far});
}

}  // namespace lostbits::intersect::capsule
