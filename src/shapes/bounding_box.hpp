// Bounding box of any primitive, over any number type.
#pragma once

#include "shapes/primitive.hpp"

namespace lostbits {

template <class T>
using BoundingBox = Box<T>;
/// The shape of a bounding box; the forms of boxes intersect it.
inline constexpr Shape bounding_box_shape = shape_as<Box>;

/// True if a shape has a bounding box. Planes have none: they have a direction, and no length that limits them.
inline bool has_bounding_box(Shape shape) {
    if (!is_primitive(shape)) return false;
    bool has_direction = false, has_length = false;
    for (const Key& key : row_of(shape).keys) {
        has_direction = has_direction || key.kind == Key::Kind::direction;
        has_length = has_length || key.is_length();
    }
    return has_length || !has_direction;
}

/// Returns the bounding box of a primitive from its own numbers, without its matrix: the box around the points among
/// its keys, extended on each side by the longest of its lengths, or by the sum of both for a torus.
///
/// This is the smallest box for spheres, ellipsoids, capsules, triangles and boxes. For cylinders, tubes, cones and
/// discs it is the box that renderers take, and the smallest one may be smaller. Sums round as T does.
template <Number T>
BoundingBox<T> bounding_box_of(const Primitive<T>& primitive) {
    BoundingBox<T> bounding_box{primitive.point(0), primitive.point(0)};
    Vec<T> extension(T(0), T(0), T(0));
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        if (key.kind == Key::Kind::direction) return;
        for (int i = 0; i < 3; ++i) {
            const T& x = primitive.numbers[k + (key.kind == Key::Kind::length ? 0 : static_cast<std::size_t>(i))];
            if (key.is_length()) {
                extension[i] =
                    key.limit == Key::Limit::positive_below_previous ? extension[i] + x : max(extension[i], x);
            } else {
                bounding_box.lo[i] = min(bounding_box.lo[i], x);
                bounding_box.hi[i] = max(bounding_box.hi[i], x);
            }
        }
    });
    return {bounding_box.lo - extension, bounding_box.hi + extension};
}

/// Returns the bounding box of the eight corners of a box, each moved by `map_point(corner)`.
template <Number T, class MapPoint>
BoundingBox<T> bounding_box_of_corners(const BoundingBox<T>& box, const MapPoint& map_point) {
    BoundingBox<T> bounding_box = box;
    for (int corner = 0; corner < 8; ++corner) {
        const auto side = [&](int i) { return (corner >> i & 1) != 0 ? box.hi[i] : box.lo[i]; };
        const Vec<T> p = map_point(Vec<T>(side(0), side(1), side(2)));
        for (int i = 0; i < 3; ++i) {
            bounding_box.lo[i] = corner == 0 ? p[i] : min(bounding_box.lo[i], p[i]);
            bounding_box.hi[i] = corner == 0 ? p[i] : max(bounding_box.hi[i], p[i]);
        }
    }
    return bounding_box;
}

}  // namespace lostbits
