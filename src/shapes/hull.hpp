// Bounding box of any primitive, over any number type.
#pragma once

#include "shapes/solid.hpp"

namespace lostbits {

template <class T>
using Hull = Box<T>;
/// The shape of a bounding box; the forms of boxes intersect it.
inline constexpr Shape hull_shape = shape_as<Box>;

/// True if a shape has a bounding box. Planes have none: they have a direction, and no length that ends them.
inline bool has_hull(Shape shape) {
    if (!is_solid(shape)) return false;
    bool has_direction = false, has_length = false;
    for (const Key& key : row_of(shape).keys) {
        has_direction = has_direction || key.kind == Key::Kind::direction;
        has_length = has_length || key.is_length();
    }
    return has_length || !has_direction;
}

/// Bounding box of a primitive from its own numbers, without its matrix: the box of the points of its keys, extended
/// on each side by the longest of its lengths, or by the sum of both for a torus.
///
/// This is the smallest box for spheres, ellipsoids, capsules, triangles and boxes. For cylinders, tubes, cones and
/// discs it is the box that renderers take, and the smallest one may be smaller. Sums round as T does.
template <Number T>
Hull<T> hull_of(const Solid<T>& solid) {
    Hull<T> hull{solid.point(0), solid.point(0)};
    Vec<T> reach(T(0), T(0), T(0));
    for_each_key(solid.shape, [&](const Key& key, std::size_t k) {
        if (key.kind == Key::Kind::direction) return;
        for (int i = 0; i < 3; ++i) {
            const T& x = solid.numbers[k + (key.kind == Key::Kind::length ? 0 : static_cast<std::size_t>(i))];
            if (key.is_length()) {
                reach[i] = key.limit == Key::Limit::within_before ? reach[i] + x : max(reach[i], x);
            } else {
                hull.lo[i] = min(hull.lo[i], x);
                hull.hi[i] = max(hull.hi[i], x);
            }
        }
    });
    return {hull.lo - reach, hull.hi + reach};
}

/// Bounding box of the eight corners of a box, each transformed by `to(corner)`.
template <Number T, class To>
Hull<T> hull_of_corners(const Hull<T>& box, const To& to) {
    Hull<T> hull = box;
    for (int corner = 0; corner < 8; ++corner) {
        const auto side = [&](int i) { return (corner >> i & 1) != 0 ? box.hi[i] : box.lo[i]; };
        const Vec<T> p = to(Vec<T>(side(0), side(1), side(2)));
        for (int i = 0; i < 3; ++i) {
            hull.lo[i] = corner == 0 ? p[i] : min(hull.lo[i], p[i]);
            hull.hi[i] = corner == 0 ? p[i] : max(hull.hi[i], p[i]);
        }
    }
    return hull;
}

}  // namespace lostbits
