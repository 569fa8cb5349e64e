// Affine maps of space over any number: a matrix of three rows and four columns, applied to points and directions.
#pragma once

#include <array>
#include <cstddef>

#include "geometry/vec.hpp"

namespace lostbits {

/// The map p ↦ A p + τ, with the rows of A.
template <class T>
struct Affine {
    std::array<Vec<T>, 3> rows;
    Vec<T> shift;

    /// Builds the map from `number_at(0)` to `number_at(11)`: a matrix of three rows and four columns, row by row.
    template <class Numbers>
    static constexpr Affine of(const Numbers& number_at) {
        const auto row = [&number_at](std::size_t k) {
            return Vec<T>(number_at(k), number_at(k + 1), number_at(k + 2));
        };
        return {{row(0), row(4), row(8)}, {number_at(3), number_at(7), number_at(11)}};
    }
    /// Calls `visit` for the twelve numbers, row by row.
    template <class Visit>
    constexpr void for_each_number(const Visit& visit) const {
        for (int i = 0; i < 3; ++i) {
            const Vec<T>& row = rows[i];
            visit(row.x);
            visit(row.y);
            visit(row.z);
            visit(shift[i]);
        }
    }
    static constexpr std::size_t number_count = 12;

    /// A v, each component (a v.x + b v.y) + c v.z.
    [[nodiscard]] Vec<T> linear(const Vec<T>& v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
    /// A p + τ, each component ((a p.x + b p.y) + c p.z) + τ.
    [[nodiscard]] Vec<T> point(const Vec<T>& p) const { return linear(p) + shift; }

    /// Columns of adj(A) = det(A) A⁻¹: b × c, c × a, a × b of the rows a, b, c.
    [[nodiscard]] std::array<Vec<T>, 3> adjugate() const {
        return {cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])};
    }
    [[nodiscard]] T determinant() const { return dot(rows[0], cross(rows[1], rows[2])); }
};

/// Multiplies the matrix with the columns u₀, u₁, u₂ by v: v.x u₀ + v.y u₁ + v.z u₂.
template <Number T>
Vec<T> times(const std::array<Vec<T>, 3>& columns, const Vec<T>& v) {
    return v.x * columns[0] + v.y * columns[1] + v.z * columns[2];
}

}  // namespace lostbits
