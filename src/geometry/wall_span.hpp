// The crossings of a line and a tube, over any number. A tube is a quadric surface between two planes, without caps.
#pragma once

#include <optional>

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"

namespace lostbits {

/// The near and the far root of a quadratic, a > 0. Each root counts if it lies between the planes of the capped
/// primitive. The surface has no inside: a line may enter through an open end and meet only the far side, or not meet
/// the surface at all. A line parallel to the axis has no crossing, even if it lies in the surface.
template <class T>
struct WallSpan {
    CappedSpan<T> primitive;
    T d2;  ///< d·d

    static constexpr int crossing_count = 2;
    static constexpr bool may_hit_beyond_touch = true;

    [[nodiscard]] SurfaceCrossing<mask_t<T>> crossing(int i) const {
        const T zero(0);
        const auto& [side, planes_entry, planes_exit, at_planes_entry, at_planes_exit, crossed, closed, open,
                     direction_square] = primitive;
        const auto entry_order = i == 0 ? at_planes_entry.order_of_near_root() : at_planes_entry.order_of_far_root();
        const auto exit_order = i == 0 ? at_planes_exit.order_of_near_root() : at_planes_exit.order_of_far_root();
        const auto is_quadratic = side.a > zero;
        return {is_quadratic && closed && side.q >= zero && !entry_order.less && exit_order.at_most,
                is_quadratic && open && side.q > zero && !entry_order.at_most && exit_order.less};
    }
    /// Compares the near root (i = 0) or the far root with t.
    template <class At = Fraction<T>>
    [[nodiscard]] Order<mask_t<T>> compare_crossing(int i, const At& t) const {
        const auto quadratic = quadratic_at(primitive.side, t);
        return i == 0 ? quadratic.order_of_near_root() : quadratic.order_of_far_root();
    }
};

/// First and last t at which the line crosses the surface. Returns nothing if these are not known.
template <Number T>
std::optional<Ends<T>> ends_of(const WallSpan<T>& span) {
    const auto near_crossing = span.crossing(0).closed, far_crossing = span.crossing(1).closed;
    const bool is_near_hit = is_certain(near_crossing), is_far_hit = is_certain(far_crossing);
    if ((!is_near_hit && !is_certain(!near_crossing)) || (!is_far_hit && !is_certain(!far_crossing)) ||
        !(is_near_hit || is_far_hit))
        return std::nullopt;
    const Ends<T> roots = *ends_of(span.primitive.side);
    return Ends<T>{is_near_hit ? roots.near : roots.far, is_far_hit ? roots.far : roots.near};
}

}  // namespace lostbits
