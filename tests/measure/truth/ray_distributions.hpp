// Rays chosen to break a reference: each distribution aims at one way of being wrong.
#pragma once

#include "measure/seeded.hpp"

namespace lostbits::test {

struct RaySample {
    Ray<double> ray;
    Sphere<double> sphere;
};

struct RayDistribution {
    const char* name;
    /// Promise of the distribution. It is checked exactly, so that a generator that misses its aim fails too.
    enum class Promise { none, tangent_line, on_surface, inside } promise;
    RaySample (*make)(Seeded&, const FloatFormat& storage);
    /// Rays per storage format: fewer where exponents are wide and exact arithmetic is slow.
    int rays_binary32, rays_binary64;
    /// At most this many binary32 rays may need more than double-double. A formula of the truth that cancels would
    /// still be right, but more rays would need higher precision: this limit notices it.
    int max_escalated;
};

// Near: inputs within a few binades of each other.
RaySample random_ray(Seeded&, const FloatFormat&);
RaySample near_tangent(Seeded&, const FloatFormat&);
RaySample tangent(Seeded&, const FloatFormat&);
RaySample on_surface(Seeded&, const FloatFormat&);
RaySample near_surface(Seeded&, const FloatFormat&);
RaySample inside(Seeded&, const FloatFormat&);
RaySample behind(Seeded&, const FloatFormat&);
RaySample far_away(Seeded&, const FloatFormat&);
RaySample huge_sphere(Seeded&, const FloatFormat&);
RaySample scaled_direction(Seeded&, const FloatFormat&);
RaySample tie(Seeded&, const FloatFormat&);

// Wide: exponents anywhere, squares beyond double's range, proofs of thousands of bits.
RaySample near_tie(Seeded&, const FloatFormat&);
RaySample subnormal(Seeded&, const FloatFormat&);
RaySample overflowing(Seeded&, const FloatFormat&);
RaySample mixed_exponents(Seeded&, const FloatFormat&);
RaySample wide_tangent(Seeded&, const FloatFormat&);
RaySample wide_contact(Seeded&, const FloatFormat&);

// Powers of two: t or the distance on one, or so near that bounds of 2^-72 cannot tell.
RaySample power_contact(Seeded&, const FloatFormat&);
RaySample power_distance(Seeded&, const FloatFormat&);
RaySample power_tangent(Seeded&, const FloatFormat&);
RaySample power_beside(Seeded&, const FloatFormat&);

inline constexpr RayDistribution near_distributions[] = {
    {"random", RayDistribution::Promise::none, random_ray, 200'000, 200'000, 0},
    {"near tangent", RayDistribution::Promise::none, near_tangent, 150'000, 150'000, 0},
    {"tangent", RayDistribution::Promise::tangent_line, tangent, 50'000, 50'000, 0},
    {"on surface", RayDistribution::Promise::on_surface, on_surface, 40'000, 40'000, 0},
    {"near surface", RayDistribution::Promise::none, near_surface, 40'000, 40'000, 300},
    {"inside", RayDistribution::Promise::inside, inside, 40'000, 40'000, 0},
    {"behind", RayDistribution::Promise::none, behind, 30'000, 30'000, 0},
    {"far away", RayDistribution::Promise::none, far_away, 50'000, 50'000, 0},
    {"huge sphere", RayDistribution::Promise::none, huge_sphere, 50'000, 50'000, 8'000},
    {"scaled direction", RayDistribution::Promise::none, scaled_direction, 30'000, 30'000, 0},
};

inline constexpr RayDistribution power_distributions[] = {
    {"power contact", RayDistribution::Promise::none, power_contact, 10'000, 10'000, 0},
    {"power distance", RayDistribution::Promise::inside, power_distance, 10'000, 10'000, 0},
    {"power tangent", RayDistribution::Promise::tangent_line, power_tangent, 10'000, 10'000, 0},
    {"power beside", RayDistribution::Promise::none, power_beside, 10'000, 10'000, 0},
};

inline constexpr RayDistribution wide_distributions[] = {
    {"tie", RayDistribution::Promise::none, tie, 50'000, 50'000, 0},
    {"near tie", RayDistribution::Promise::none, near_tie, 30'000, 30'000, 0},
    {"subnormal", RayDistribution::Promise::none, subnormal, 30'000, 30'000, 1'200},
    {"overflowing", RayDistribution::Promise::none, overflowing, 30'000, 30'000, 0},
    {"mixed exponents", RayDistribution::Promise::none, mixed_exponents, 30'000, 30'000, 100},
    {"wide tangent", RayDistribution::Promise::tangent_line, wide_tangent, 10'000, 20'000, 9'000},
    {"wide contact", RayDistribution::Promise::none, wide_contact, 10'000, 20'000, 8'000},
};

}  // namespace lostbits::test
