// Three-vectors over any number. glm::vec holds the components. dot and cross are defined here and not taken from glm:
// the order of their additions is part of what is measured, and glm's versions require IEEE types.
#pragma once

#ifndef GLM_FORCE_XYZW_ONLY
#error "define GLM_FORCE_XYZW_ONLY for every file: glm::vec holds non-trivial numbers only then"
#endif
#include <glm/vec3.hpp>
#include <string_view>

#include "number/concept.hpp"

namespace lostbits {

template <class T>
using Vec = glm::vec<3, T>;

/// a·b = (a.x b.x + a.y b.y) + a.z b.z, summed from left to right. Numbers with an error bound compute one bound for
/// the whole sum.
template <Number T>
T dot(const Vec<T>& a, const Vec<T>& b) {
    if constexpr (requires { sum_of_products(a.x, b.x, a.y, b.y, a.z, b.z); })
        return sum_of_products(a.x, b.x, a.y, b.y, a.z, b.z);
    else return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// a·a, with the squares summed in the same order.
template <Number T>
T square(const Vec<T>& a) {
    if constexpr (requires { sum_of_squares(a.x, a.y, a.z); }) return sum_of_squares(a.x, a.y, a.z);
    else return square(a.x) + square(a.y) + square(a.z);
}

/// a × b. Each component is one difference of two products.
template <Number T>
Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
    if constexpr (requires { difference_of_products(a.x, b.x, a.y, b.y); })
        return Vec<T>(difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
                      difference_of_products(a.x, b.y, a.y, b.x));
    else return Vec<T>(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/// |a| = √(a·a). It overflows and underflows where a·a does; this is part of what is measured.
template <Number T>
T length(const Vec<T>& a) {
    return sqrt(square(a));
}

/// v/|v|, with a quotient for each component; 0/0 for v = 0.
template <Number T>
Vec<T> unit_of(const Vec<T>& v) {
    const T length_of_v = length(v);
    return Vec<T>(v.x / length_of_v, v.y / length_of_v, v.z / length_of_v);
}

/// Names each component `label`.
template <Number T>
const Vec<T>& named(std::string_view label, const Vec<T>& v) {
    named(label, v.x);
    named(label, v.y);
    named(label, v.z);
    return v;
}

/// Two unit vectors perpendicular to v and to each other. v must not be 0.
template <class T>
struct PerpendicularAxes {
    Vec<T> first, second;

    explicit PerpendicularAxes(const Vec<T>& v)
        : first(unit(cross(v, axis_of_smallest(v)))), second(unit(cross(v, first))) {}

private:
    static Vec<T> unit(const Vec<T>& v) { return (T(1) / length(v)) * v; }
    /// Unit vector along the axis on which v has its smallest component.
    static Vec<T> axis_of_smallest(const Vec<T>& v) {
        const T x = abs(v.x), y = abs(v.y), z = abs(v.z);
        return Vec<T>(x <= y && x <= z ? T(1) : T(0), y < x && y <= z ? T(1) : T(0), z < x && z < y ? T(1) : T(0));
    }
};

}  // namespace lostbits
