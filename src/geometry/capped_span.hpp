// Where a line is inside of a surface of a quadratic that two planes cut off, over any number: cylinders with caps.
#pragma once

#include <optional>

#include "geometry/span.hpp"

namespace lostbits {

/// Those t of a quadratic's that also lie between two parallel planes: from the larger of the near root and `entry` to
/// the smaller of the far root and `exit`. A line beside the axis has a = h = q = 0 and is within the side for all t or
/// for none, by the sign of c; one beside the planes has −1/0 and 1/0 for entry and exit, and `closed` and `open` say
/// whether it is between them. Roots are compared with fractions by the sign of the polynomial and of its slope there,
/// so that no root is taken to decide.
template <class T>
struct CappedSpan {
    QuadraticSpan<T> side;
    Fraction<T> entry, exit;
    mask_t<T> crossed;
    mask_t<T> closed;
    mask_t<T> open;
    T d2;  ///< d·d

    /// Whether some point of the line lies in the closed and in the open solid.
    [[nodiscard]] mask_t<T> is_met() const {
        const T zero(0);
        const auto within = side.q >= zero && (side.a > zero || side.c <= zero);
        return closed && within && (!crossed || (near_to(exit).at_most && !far_to(entry).less));
    }
    [[nodiscard]] mask_t<T> is_open() const {
        const T zero(0);
        const auto within = side.q > zero || (side.a <= zero && side.c < zero);
        return open && within && (!crossed || (near_to(exit).less && !far_to(entry).at_most));
    }
    /// Whether the line enters before t, or no later, and whether it leaves so, where it meets the closed solid.
    [[nodiscard]] Order<mask_t<T>> enters_to(const Fraction<T>& t) const {
        const auto side_to = near_to(t), cap_to = order_of(entry, t);
        return {side_to.less && (!crossed || cap_to.less), side_to.at_most && (!crossed || cap_to.at_most)};
    }
    [[nodiscard]] Order<mask_t<T>> leaves_to(const Fraction<T>& t) const {
        const auto side_to = far_to(t), cap_to = order_of(exit, t);
        return {side_to.less || (crossed && cap_to.less), side_to.at_most || (crossed && cap_to.at_most)};
    }
    /// Whether it is a cap by which it enters, or leaves; of a rim either.
    [[nodiscard]] mask_t<T> enters_by_cap() const { return crossed && near_to(entry).at_most; }
    [[nodiscard]] mask_t<T> leaves_by_cap() const { return crossed && !far_to(exit).less; }

private:
    [[nodiscard]] Order<mask_t<T>> near_to(const Fraction<T>& t) const { return quadratic_at(side, t).near_root(); }
    [[nodiscard]] Order<mask_t<T>> far_to(const Fraction<T>& t) const { return quadratic_at(side, t).far_root(); }
};

/// Both ends; nothing where it is not known by what it enters and leaves.
template <Number T>
std::optional<Ends<T>> ends_of(const CappedSpan<T>& s) {
    if (!is_certain(s.is_met())) return std::nullopt;
    const auto side = *ends_of(s.side);
    const auto one_of = [](const auto& by_cap, const Fraction<T>& cap, const T& root) -> std::optional<T> {
        if (is_certain(by_cap)) return cap.n / cap.m;
        return is_certain(!by_cap) ? std::optional(root) : std::nullopt;
    };
    const auto near = one_of(s.enters_by_cap(), s.entry, side.near), far = one_of(s.leaves_by_cap(), s.exit, side.far);
    return near && far ? std::optional(Ends<T>{*near, *far}) : std::nullopt;
}

}  // namespace lostbits
