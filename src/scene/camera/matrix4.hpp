// 4 by 4 matrices over any number, as projections need them; points are columns.
#pragma once

#include <array>

#include "geometry/vec.hpp"

namespace lostbits::scene::camera {

/// A point before it is divided by w.
template <class T>
struct Homogeneous {
    Vec<T> at;
    T w;
};

template <class T>
struct Matrix4 {
    std::array<std::array<T, 4>, 4> rows;

    /// ((a x + b y) + c z) + d for each row.
    [[nodiscard]] Homogeneous<T> point(const Vec<T>& p) const {
        const auto row = [&](std::size_t i) {
            return rows[i][0] * p.x + rows[i][1] * p.y + rows[i][2] * p.z + rows[i][3];
        };
        return {{row(0), row(1), row(2)}, row(3)};
    }
    /// Of a matrix whose last row is 0 0 0 1.
    [[nodiscard]] Vec<T> affine(const Vec<T>& p) const { return point(p).at; }
    [[nodiscard]] Vec<T> linear(const Vec<T>& v) const {
        const auto row = [&](std::size_t i) { return rows[i][0] * v.x + rows[i][1] * v.y + rows[i][2] * v.z; };
        return {row(0), row(1), row(2)};
    }
    [[nodiscard]] Vec<T> shift() const { return {rows[0][3], rows[1][3], rows[2][3]}; }

    /// Each number through `f`, row by row, to a matrix over what that returns.
    template <class F>
    [[nodiscard]] auto each(const F& f) const {
        return Matrix4<decltype(f(rows[0][0]))>::of([&](std::size_t i, std::size_t j) { return f(rows[i][j]); });
    }
    template <class F>
    static Matrix4 of(const F& f) {
        const auto row = [&f](std::size_t i) { return std::array<T, 4>{f(i, 0), f(i, 1), f(i, 2), f(i, 3)}; };
        return {{row(0), row(1), row(2), row(3)}};
    }
};

/// First b, then a: sums of four products, left to right.
template <class T>
Matrix4<T> operator*(const Matrix4<T>& a, const Matrix4<T>& b) {
    return Matrix4<T>::of([&](std::size_t i, std::size_t j) {
        const auto& row = a.rows[i];
        return row[0] * b.rows[0][j] + row[1] * b.rows[1][j] + row[2] * b.rows[2][j] + row[3] * b.rows[3][j];
    });
}

/// adj(M) times 1/det(M), the minors from differences of two products: as GLM's `inverse`, glam's and Babylon's are.
template <class T>
Matrix4<T> inverse(const Matrix4<T>& m) {
    const auto& a = m.rows;
    const auto two_by_two = [&a](std::size_t above, std::size_t j, std::size_t k) {
        return a[above][j] * a[above + 1][k] - a[above][k] * a[above + 1][j];
    };
    const auto cofactor = [&](std::size_t i, std::size_t j) {
        const std::size_t x = j == 0 ? 1 : 0, y = j <= 1 ? 2 : 1, z = j == 3 ? 2 : 3;
        const std::size_t beside = i ^ 1, pair = i < 2 ? 2 : 0;
        const auto& row = a[beside];
        const T minor =
            row[x] * two_by_two(pair, y, z) - row[y] * two_by_two(pair, x, z) + row[z] * two_by_two(pair, x, y);
        return (i + j) % 2 == 0 ? minor : T(-minor);
    };
    const auto adjugate = Matrix4<T>::of([&](std::size_t i, std::size_t j) { return cofactor(j, i); });
    const auto part = [&](std::size_t j) { return a[0][j] * adjugate.rows[j][0]; };
    const T over_det = T(1) / ((part(0) + part(1)) + (part(2) + part(3)));
    return adjugate.each([&](const T& x) -> T { return x * over_det; });
}

}  // namespace lostbits::scene::camera
