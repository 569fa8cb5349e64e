#include "shapes/transform.hpp"

#include <algorithm>
#include <cmath>

#include "number/error.hpp"
#include "number/interval.hpp"
#include "number/real.hpp"
#include "shapes/lift.hpp"

namespace lostbits {

namespace {

template <class S>
bool is_finite(const S& x) {
    using std::isfinite;
    return isfinite(x);
}

/// Returns the exact sign of the determinant, a sum of six products of three numbers. For doubles, an interval of
/// 3·(1024 + 1074) + 8 bits holds it exactly.
template <class S>
int exact_orientation(std::span<const S, 12> matrix) {
    for (int bits = 256; bits <= 32768; bits *= 2) {
        const Interval::Precision precision(bits);
        const Affine<Interval> m = Affine<Interval>::of([&](std::size_t k) { return Interval(matrix[k]); });
        const Interval det = m.determinant(), zero(0);
        if ((det > zero).is_yes()) return 1;
        if ((det < zero).is_yes()) return -1;
        if (det.is_exact()) return 0;
    }
    throw Error(ExitStatus::internal, "the sign of a determinant is still unknown at 32768 bits");
}

}  // namespace

int orientation_of(std::span<const double, 12> matrix) {
    if (!std::ranges::all_of(matrix, is_finite<double>)) return 0;
    // Each product has three roundings, and sums and differences have five. So the error is at most γ(8) times the sum
    // of the sizes of the products, plus what underflows.
    const Affine<double> m = Affine<double>::of([&](std::size_t k) { return matrix[k]; });
    const auto abs_of = [](const Vec<double>& v) {
        return Vec<double>(std::fabs(v.x), std::fabs(v.y), std::fabs(v.z));
    };
    const Vec<double> a = abs_of(m.rows[0]), b = abs_of(m.rows[1]), c = abs_of(m.rows[2]);
    const double absolute_sum =
        a.x * (b.y * c.z + b.z * c.y) + a.y * (b.z * c.x + b.x * c.z) + a.z * (b.x * c.y + b.y * c.x);
    const double det = m.determinant();
    // Below 2^100, a product that underflows changes the sum by less than 2^-970.
    const bool in_range = std::ranges::all_of(matrix, [](double x) { return std::fabs(x) < 0x1p100; });
    if (in_range && std::fabs(det) > 0x1p-48 * absolute_sum + 0x1p-900) return det > 0 ? 1 : -1;
    return exact_orientation(matrix);
}

int orientation_of(std::span<const Real, 12> matrix) {
    return std::ranges::all_of(matrix, is_finite<Real>) ? exact_orientation(matrix) : 0;
}

}  // namespace lostbits
