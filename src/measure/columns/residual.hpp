// Distance of a point from a surface, for packs of doubles and for single doubles.
#pragma once

#include "number/wide/running_error.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::columns {

/// Computes `relative_distance` of the point p, with a running bound, for the primitive with `number(0)`, `number(1)`,
/// …. True if the result is accurate to 2^-40 of itself, or so small that the rounding noise of a double hides it.
template <template <class> class S, class P, class Numbers>
auto find_residual(const P* p, const Numbers& number, P& value) {
    using E = number::wide::RunningError<number::wide::TwoWords<P>>;
    using lostbits::abs, lostbits::max;
    const auto exact = [](const P& x) { return E({x, P(0)}); };
    const S<E> shape = primitive_from<S, E>([&](std::size_t k) { return exact(number(static_cast<int>(k))); });
    const E residual = shape.relative_distance({exact(p[0]), exact(p[1]), exact(p[2])});
    value = residual.first();
    return residual.radius() <= max(P(0x1p-40) * abs(value), P(0x1p-90));
}

}  // namespace lostbits::measure::columns
