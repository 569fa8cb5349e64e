// Functions that several triangle forms share.
#pragma once

#include "geometry/ray.hpp"
#include "intersect/info.hpp"
#include "number/concept.hpp"
#include "shapes/triangle/triangle.hpp"

namespace lostbits::intersect::triangle {

/// Returns a·b, summed from the last component as in Embree.
template <Number T>
T dot_from_z(const Vec<T>& a, const Vec<T>& b) {
    return a.x * b.x + (a.y * b.y + a.z * b.z);
}

template <Number T>
mask_t<T> is_not_zero(const T& x) {
    return x < T(0) || x > T(0);
}

/// The axis of the largest component of a vector, as masks for x and y; neither is set for z.
template <Number T>
struct LargestComponent {
    mask_t<T> is_x, is_y;

    /// Takes the absolute values of the components. If several are the largest, the last of them counts.
    explicit LargestComponent(const Vec<T>& size)
        : is_x(size.x > size.y && size.x > size.z), is_y(!(size.x > size.y) && size.y > size.z) {}

    /// Rotates the components, x to y to z to x, until the component of this axis is the last.
    [[nodiscard]] Vec<T> rotate_to_last(const Vec<T>& v) const {
        return Vec<T>(select_by_axis(v.y, v.z, v.x), select_by_axis(v.z, v.x, v.y), select_by_axis(v.x, v.y, v.z));
    }
    /// Rotates the components until the component of this axis is the first.
    [[nodiscard]] Vec<T> rotate_to_first(const Vec<T>& v) const {
        return Vec<T>(select_by_axis(v.x, v.y, v.z), select_by_axis(v.y, v.z, v.x), select_by_axis(v.z, v.x, v.y));
    }

private:
    [[nodiscard]] T select_by_axis(const T& if_x, const T& if_y, const T& if_z) const {
        return select(is_x, if_x, select(is_y, if_y, if_z));
    }
};

template <Number T>
Vec<T> absolute_values(const Vec<T>& v) {
    return Vec<T>(abs(v.x), abs(v.y), abs(v.z));
}

}  // namespace lostbits::intersect::triangle
