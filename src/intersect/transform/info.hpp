// Description of a transform method, which converts a ray to the space of a primitive.
#pragma once

#include <array>
#include <string_view>

#include "intersect/info.hpp"
#include "shapes/transform.hpp"

namespace lostbits::intersect::transform {

struct TransformMethodInfo {
    std::string_view name;  ///< such as `pbrt` in `sphere.unified@pbrt`, unique
    std::string_view title;
    std::string_view source;
    /// The directions that the method takes in the world. With unit directions, t is a distance.
    Direction direction = Direction::any;
    bool normalises = false;  ///< the form receives directions of length one
};

/// The steps of a transform method, in this order. `measure::answer` distinguishes the rounding errors of the steps.
enum class TransformStep {
    inverse,    ///< inverts the stored matrix
    origin,     ///< converts the origin of the ray to the space of the primitive
    direction,  ///< converts its direction
    finish,     ///< normalises the ray or moves it along itself; scales the primitive
    form,       ///< runs the form of the shape
    back        ///< converts t to the world
};
inline constexpr std::array<std::string_view, 6> step_names{"inverse", "origin", "direction", "finish", "form", "back"};

/// The two matrices of a transformed primitive: one is stored, the other is its inverse.
template <class T>
struct MatrixPair {
    Affine<T> to_world, to_object;
};

/// The ray that the form receives. t in the world is t of this ray divided by `length`. The primitive is `scale` times
/// as large.
template <class T>
struct ObjectRay {
    Ray<T> ray;
    T length, scale;
};

/// Base of the methods whose `finish` does not change the ray: t is the same in both spaces, since affine maps keep it.
struct SameTMethod {
    template <Number T>
    static ObjectRay<T> finish(const MatrixPair<T>&, const Vec<T>&, const Ray<T>& ray) {
        return {ray, T(1), T(1)};
    }
    template <Number T>
    static T back(const MatrixPair<T>&, const Ray<T>&, const ObjectRay<T>&, const T& t) {
        return t;
    }
};

/// Base of methods that normalise: d' = d/|d|, with a quotient for each component, and t = t'/|d|.
struct NormalisingMethod {
    template <Number T>
    static ObjectRay<T> finish(const MatrixPair<T>&, const Vec<T>&, const Ray<T>& ray) {
        const T length_of_d = named("|d'|", length(ray.direction));
        const Vec<T>& d = ray.direction;
        return {{ray.origin, {d.x / length_of_d, d.y / length_of_d, d.z / length_of_d}}, length_of_d, T(1)};
    }
    template <Number T>
    static T back(const MatrixPair<T>&, const Ray<T>&, const ObjectRay<T>& object_ray, const T& t) {
        return named("t'/|d'|", t / object_ray.length);
    }
};

/// [A⁻¹, −A⁻¹τ] from the columns of adj(A). `over_det` divides each number of these columns by det(A).
template <Number T, class OverDet>
Affine<T> inverse_from(const std::array<Vec<T>, 3>& columns, const Vec<T>& shift, const OverDet& over_det) {
    const auto row = [&](int i) {
        return Vec<T>(named("A^-1", over_det(columns[0][i])), named("A^-1", over_det(columns[1][i])),
                      named("A^-1", over_det(columns[2][i])));
    };
    Affine<T> inverse{{row(0), row(1), row(2)}, shift};
    inverse.shift = -inverse.linear(shift);
    return inverse;
}
template <Number T>
Affine<T> adjugate_over_determinant(const Affine<T>& m) {
    const auto columns = m.adjugate();
    const T det = named("det", m.determinant());
    return inverse_from(columns, m.shift, [&](const T& c) { return c / det; });
}
/// The same inverse with a single division: the adjugate is multiplied by 1/det(A).
template <Number T>
Affine<T> adjugate_times_reciprocal(const Affine<T>& m) {
    const auto columns = m.adjugate();
    const T r = named("1/det", T(1) / m.determinant());
    return inverse_from(columns, m.shift, [&](const T& c) { return c * r; });
}

/// fma(a.x, p.x, fma(a.y, p.y, fma(a.z, p.z, τ))) for each row: the last component first.
template <Number T>
Vec<T> point_by_fma(const Affine<T>& m, const Vec<T>& p) {
    const auto row_product = [&](std::size_t i) {
        const Vec<T>& a = m.rows[i];
        return fma(a.x, p.x, fma(a.y, p.y, fma(a.z, p.z, m.shift[static_cast<int>(i)])));
    };
    return {row_product(0), row_product(1), row_product(2)};
}
template <Number T>
Vec<T> linear_by_fma(const Affine<T>& m, const Vec<T>& v) {
    const auto row_product = [&](std::size_t i) {
        const Vec<T>& a = m.rows[i];
        return fma(a.x, v.x, fma(a.y, v.y, a.z * v.z));
    };
    return {row_product(0), row_product(1), row_product(2)};
}

}  // namespace lostbits::intersect::transform
