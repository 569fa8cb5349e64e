// Signed distance fields: how far a point is from the surface, negative inside. Sources: SDF Sphere Marching (lesson
// P0-C1); J. C. Hart, "Sphere tracing", The Visual Computer 12 (1996).
#pragma once

#include "shapes/box/box.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits::intersect::sdf {

/// |p − G| − r
template <Number T>
T distance(const Sphere<T>& sphere, const Vec<T>& p) {
    return length(p - sphere.centre) - sphere.radius;
}

/// With q = max(lo − p, p − hi) in each component, how far p lies beyond the nearer plane of each pair:
/// |max(q, 0)| + min(max(q.x, max(q.y, q.z)), 0). Outside one of the two terms is zero, inside the other.
template <Number T>
T distance(const Box<T>& box, const Vec<T>& p) {
    const T zero(0);
    const auto beyond = [&](const T& lo, const T& hi, const T& x) { return max(lo - x, x - hi); };
    const Vec<T> q(beyond(box.lo.x, box.hi.x, p.x), beyond(box.lo.y, box.hi.y, p.y), beyond(box.lo.z, box.hi.z, p.z));
    const T outside = length(Vec<T>(max(q.x, zero), max(q.y, zero), max(q.z, zero)));
    return outside + min(max(q.x, max(q.y, q.z)), zero);
}

}  // namespace lostbits::intersect::sdf
