// Transforms vectors into a frame whose z axis is the axis of a primitive.
#pragma once

#include "geometry/vec.hpp"
#include "number/concept.hpp"

namespace lostbits::intersect::cylinder {

/// The unit axes x, y and z of the frame, with z along the given axis. Source: pbrt-v4, CoordinateSystem (Duff et al.
/// 2017).
template <Number T>
struct AxisFrame {
    T height;
    Vec<T> z;

private:
    T sign_, a_, b_;

public:
    Vec<T> x, y;

    explicit AxisFrame(const Vec<T>& axis)
        : height(named("height", length(axis))),
          z(axis.x / height, axis.y / height, axis.z / height),
          sign_(copysign(T(1), z.z)),
          a_(T(-1) / (sign_ + z.z)),
          b_(z.x * z.y * a_),
          x(T(1) + sign_ * square(z.x) * a_, sign_ * b_, -sign_ * z.x),
          y(b_, sign_ + square(z.y) * a_, -z.y) {}
    [[nodiscard]] Vec<T> to_frame(const Vec<T>& p) const { return Vec<T>(dot(p, x), dot(p, y), dot(p, z)); }
};

}  // namespace lostbits::intersect::cylinder
