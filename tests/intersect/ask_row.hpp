// Evaluates a row of the table for one ray and one primitive. Loops over all forms use it, so it is compiled once.
#pragma once

#include <limits>
#include <type_traits>

#include "intersect/table/table.hpp"

namespace lostbits::test {

template <class S>
Hit<S> ask_row(const intersect::table::Intersector& row, const Ray<S>& ray, const Primitive<S>& primitive,
               std::type_identity_t<S> tmax = std::numeric_limits<S>::infinity()) {
    const auto one = [](const S& x) { return std::span<const S>(&x, 1); };
    const Vec<S>&o = ray.origin, &d = ray.direction;
    const intersect::table::RayBatch<S> rays{one(o.x), one(o.y), one(o.z), one(d.x), one(d.y), one(d.z), one(tmax)};
    Hit<S> found{};
    std::uint8_t hit = 0;
    const intersect::table::HitBatch<S> hits{{&found.t, 1}, {&found.near, 1}, {&found.far, 1}, {&hit, 1}};
    if constexpr (sizeof(S) == sizeof(float)) row.native32(rays, primitive, hits);
    else row.native64(rays, primitive, hits);
    found.hit = hit != 0;
    return found;
}

}  // namespace lostbits::test
