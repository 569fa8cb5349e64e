// The transform of pbrt-v4 into the space of an instance: an inverse from differences of products, and an origin that
// is moved along the ray to the edge of its error bound.
#pragma once

#include "geometry/rounding_bound.hpp"
#include "intersect/transform/info.hpp"

namespace lostbits::intersect::transform {

struct PbrtTransform : SameTMethod {
    static constexpr TransformMethodInfo info{
        .name = "pbrt",
        .title = "inverse by compensated products; the origin moved by its error bound, t not moved back",
        .source = "pbrt-v4, src/pbrt/util/math.h Inverse, transform.h ApplyInverse, cpu/primitive.cpp",
    };

    /// The inverse of pbrt, which accepts any last row, for the last row (0 0 0 1): det = s₀ m₂₂ − s₁ m₂₁ + s₃ m₂₀ with
    /// the minors s of the first two rows. Sums and products are compensated, and each cofactor is multiplied by 1/det.
    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        const Vec<T>&a = m.rows[0], &b = m.rows[1], &c = m.rows[2], &t = m.shift;
        const T s0 = difference_of_products(a.x, b.y, b.x, a.y), s1 = difference_of_products(a.x, b.z, b.x, a.z);
        const T s2 = difference_of_products(a.x, t.y, b.x, t.x), s3 = difference_of_products(a.y, b.z, b.y, a.z);
        const T s4 = difference_of_products(a.y, t.y, b.y, t.x), s5 = difference_of_products(a.z, t.y, b.z, t.x);
        const T s = named("1/det", T(1) / sum_of_products<T>({s0, -s1, s3}, {c.z, c.y, c.x}));
        const auto cofactor = [&](const T& p, const T& q, const T& u, const T& v) {
            return named("A^-1", s * sum_of_products<T>({p, u}, {q, v}));
        };
        const auto shift = [&](const Vec<T>& u, const Vec<T>& v) {
            return named("-A^-1 T", s * sum_of_products<T>({u.x, u.y, u.z}, {v.x, v.y, v.z}));
        };
        return {{Vec<T>(cofactor(b.y, c.z, -b.z, c.y), cofactor(-a.y, c.z, a.z, c.y), named("A^-1", s * s3)),
                 Vec<T>(cofactor(-b.x, c.z, b.z, c.x), cofactor(a.x, c.z, -a.z, c.x), named("A^-1", s * -s1)),
                 Vec<T>(cofactor(b.x, c.y, -b.y, c.x), cofactor(-a.x, c.y, a.y, c.x), named("A^-1", s * s0))},
                {shift({-c.y, c.z, -t.z}, {s5, s4, s3}), shift({c.x, t.z, -c.z}, {s5, s1, s2}),
                 shift({-c.x, c.y, -t.z}, {s4, s2, s0})}};
    }
    /// (a.x o.x + a.y o.y) + (a.z o.z + τ).
    template <Number T>
    static Vec<T> origin(const MatrixPair<T>& matrices, const Vec<T>& o) {
        const auto row_product = [&](std::size_t i) {
            const Vec<T>& a = matrices.to_object.rows[i];
            return (a.x * o.x + a.y * o.y) + (a.z * o.z + matrices.to_object.shift[static_cast<int>(i)]);
        };
        return named("o'", Vec<T>(row_product(0), row_product(1), row_product(2)));
    }
    template <Number T>
    static Vec<T> direction(const MatrixPair<T>& matrices, const Vec<T>& d) {
        return named("d'", matrices.to_object.linear(d));
    }
    /// o' + dt d' with dt = |d'|·δ/(d'·d') and δ = γ(3)(|a.x o.x| + |a.y o.y| + |a.z o.z| + |τ|), so that the moved
    /// origin does not lie before the exact one. dt is not added to the returned t.
    template <Number T>
    static ObjectRay<T> finish(const MatrixPair<T>& matrices, const Vec<T>& o, const Ray<T>& ray) {
        const T g = gamma_bound<T>(3);
        const auto bound = [&](std::size_t i) {
            const Vec<T>& a = matrices.to_object.rows[i];
            return g * (((abs(a.x * o.x) + abs(a.y * o.y)) + abs(a.z * o.z)) +
                        abs(matrices.to_object.shift[static_cast<int>(i)]));
        };
        const Vec<T>& d = ray.direction;
        const T dt =
            named("dt", dot(Vec<T>(abs(d.x), abs(d.y), abs(d.z)), Vec<T>(bound(0), bound(1), bound(2))) / square(d));
        return {{named("o' + dt d'", Vec<T>(ray.origin + dt * d)), d}, T(1), T(1)};
    }

private:
    /// a b − c d, with the rounding error of c d added back.
    template <Number T>
    static T difference_of_products(const T& a, const T& b, const T& c, const T& d) {
        const T cd = c * d;
        return fma(a, b, -cd) + fma(-c, d, cd);
    }
    /// Σ aᵢ bᵢ, from the last term to the first. The rounding errors of all products and sums are accumulated and added
    /// at the end.
    template <Number T, std::size_t n>
    static T sum_of_products(const T (&a)[n], const T (&b)[n]) {
        T value = a[n - 1] * b[n - 1], error_sum = fma(a[n - 1], b[n - 1], -value);
        for (std::size_t i = n - 1; i-- > 0;) {
            const T p = a[i] * b[i], product_error = fma(a[i], b[i], -p);
            const T next_value = p + value, part = next_value - p;
            error_sum = product_error + (error_sum + ((p - (next_value - part)) + (value - part)));
            value = next_value;
        }
        return value + error_sum;
    }
};

}  // namespace lostbits::intersect::transform
