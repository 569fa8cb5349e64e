// The crossings of a line and a tube, over any number: a quadric surface that is cut off by two planes and has no caps.
#pragma once

#include <optional>

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"

namespace lostbits {

/// The near and the far root of a quadratic, a > 0. Each counts if it lies between the planes of the capped primitive.
/// The surface has no inside: a line may enter through an open end and meet only the far side, or nothing. A line
/// parallel to the axis meets nothing, even within the wall.
template <class T>
struct WallSpan {
    CappedSpan<T> primitive;
    T d2;  ///< d·d

    static constexpr int crossings = 2;
    static constexpr bool may_hit_behind_touch = true;

    [[nodiscard]] SurfaceCrossing<mask_t<T>> crossing(int i) const {
        const T zero(0);
        const auto& [side, entry, exit, at_entry, at_exit, crossed, closed, open, size] = primitive;
        const auto from = i == 0 ? at_entry.near_root() : at_entry.far_root();
        const auto to = i == 0 ? at_exit.near_root() : at_exit.far_root();
        const auto curved = side.a > zero;
        return {curved && closed && side.q >= zero && !from.less && to.at_most,
                curved && open && side.q > zero && !from.at_most && to.less};
    }
    /// Compares a root with t.
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> order_to(int i, const At& t) const {
        const auto at = quadratic_at(primitive.side, t);
        return i == 0 ? at.near_root() : at.far_root();
    }
};

/// First and last t at which the line crosses the surface; nothing if these are not known.
template <Number T>
std::optional<Ends<T>> ends_of(const WallSpan<T>& s) {
    const auto near_met = s.crossing(0).closed, far_met = s.crossing(1).closed;
    const bool near = is_certain(near_met), far = is_certain(far_met);
    if ((!near && !is_certain(!near_met)) || (!far && !is_certain(!far_met)) || !(near || far)) return std::nullopt;
    const Ends<T> roots = *ends_of(s.primitive.side);
    return Ends<T>{near ? roots.near : roots.far, far ? roots.far : roots.near};
}

}  // namespace lostbits
