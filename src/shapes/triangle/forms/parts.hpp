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
    mask_t<T> x, y;

    /// Takes the absolute values of the components. If several are the largest, the last of them counts.
    explicit LargestComponent(const Vec<T>& size)
        : x(size.x > size.y && size.x > size.z), y(!(size.x > size.y) && size.y > size.z) {}

    /// Rotates the components, x to y to z to x, until the component of this axis is the last.
    [[nodiscard]] Vec<T> last(const Vec<T>& v) const {
        return Vec<T>(pick(v.y, v.z, v.x), pick(v.z, v.x, v.y), pick(v.x, v.y, v.z));
    }
    /// Rotates the components until the component of this axis is the first.
    [[nodiscard]] Vec<T> first(const Vec<T>& v) const {
        return Vec<T>(pick(v.x, v.y, v.z), pick(v.y, v.z, v.x), pick(v.z, v.x, v.y));
    }

private:
    [[nodiscard]] T pick(const T& if_x, const T& if_y, const T& if_z) const {
        return select(x, if_x, select(y, if_y, if_z));
    }
};

template <Number T>
Vec<T> absolute_values(const Vec<T>& v) {
    return Vec<T>(abs(v.x), abs(v.y), abs(v.z));
}

}  // namespace lostbits::intersect::triangle
