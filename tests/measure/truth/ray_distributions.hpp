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
    RaySample (*draw)(Seeded&, const FloatFormat& storage);
    /// Number of rays for each storage format: fewer where exponents are wide and exact arithmetic is slow.
    int ray_count_binary32, ray_count_binary64;
    /// At most this many binary32 rays may need more than double-double. A formula of the truth that cancels would
    /// still be right, but more rays would need higher precision: this limit notices it.
    int max_escalated_count;
};

// Narrow: inputs within a few binades of each other.
RaySample draw_random_ray(Seeded&, const FloatFormat&);
RaySample draw_near_tangent(Seeded&, const FloatFormat&);
RaySample draw_tangent(Seeded&, const FloatFormat&);
RaySample draw_on_surface(Seeded&, const FloatFormat&);
RaySample draw_near_surface(Seeded&, const FloatFormat&);
RaySample draw_inside(Seeded&, const FloatFormat&);
RaySample draw_behind(Seeded&, const FloatFormat&);
RaySample draw_far_away(Seeded&, const FloatFormat&);
RaySample draw_huge_sphere(Seeded&, const FloatFormat&);
RaySample draw_scaled_direction(Seeded&, const FloatFormat&);
RaySample draw_tie(Seeded&, const FloatFormat&);

// Wide: exponents anywhere, squares beyond double's range, proofs of thousands of bits.
RaySample draw_near_tie(Seeded&, const FloatFormat&);
RaySample draw_subnormal(Seeded&, const FloatFormat&);
RaySample draw_overflowing(Seeded&, const FloatFormat&);
RaySample draw_mixed_exponents(Seeded&, const FloatFormat&);
RaySample draw_wide_tangent(Seeded&, const FloatFormat&);
RaySample draw_wide_contact(Seeded&, const FloatFormat&);

// Powers of two: t or the distance on one, or so near that bounds of 2^-72 cannot tell.
RaySample draw_power_contact(Seeded&, const FloatFormat&);
RaySample draw_power_distance(Seeded&, const FloatFormat&);
RaySample draw_power_tangent(Seeded&, const FloatFormat&);
RaySample draw_power_beside(Seeded&, const FloatFormat&);

inline constexpr RayDistribution narrow_distributions[] = {
    {"random", RayDistribution::Promise::none, draw_random_ray, 200'000, 200'000, 0},
    {"near tangent", RayDistribution::Promise::none, draw_near_tangent, 150'000, 150'000, 0},
    {"tangent", RayDistribution::Promise::tangent_line, draw_tangent, 50'000, 50'000, 0},
    {"on surface", RayDistribution::Promise::on_surface, draw_on_surface, 40'000, 40'000, 0},
    {"near surface", RayDistribution::Promise::none, draw_near_surface, 40'000, 40'000, 300},
    {"inside", RayDistribution::Promise::inside, draw_inside, 40'000, 40'000, 0},
    {"behind", RayDistribution::Promise::none, draw_behind, 30'000, 30'000, 0},
    {"far away", RayDistribution::Promise::none, draw_far_away, 50'000, 50'000, 0},
    {"huge sphere", RayDistribution::Promise::none, draw_huge_sphere, 50'000, 50'000, 8'000},
    {"scaled direction", RayDistribution::Promise::none, draw_scaled_direction, 30'000, 30'000, 0},
};

inline constexpr RayDistribution power_distributions[] = {
    {"power contact", RayDistribution::Promise::none, draw_power_contact, 10'000, 10'000, 0},
    {"power distance", RayDistribution::Promise::inside, draw_power_distance, 10'000, 10'000, 0},
    {"power tangent", RayDistribution::Promise::tangent_line, draw_power_tangent, 10'000, 10'000, 0},
    {"power beside", RayDistribution::Promise::none, draw_power_beside, 10'000, 10'000, 0},
};

inline constexpr RayDistribution wide_distributions[] = {
    {"tie", RayDistribution::Promise::none, draw_tie, 50'000, 50'000, 0},
    {"near tie", RayDistribution::Promise::none, draw_near_tie, 30'000, 30'000, 0},
    {"subnormal", RayDistribution::Promise::none, draw_subnormal, 30'000, 30'000, 1'200},
    {"overflowing", RayDistribution::Promise::none, draw_overflowing, 30'000, 30'000, 0},
    {"mixed exponents", RayDistribution::Promise::none, draw_mixed_exponents, 30'000, 30'000, 100},
    {"wide tangent", RayDistribution::Promise::tangent_line, draw_wide_tangent, 10'000, 20'000, 9'000},
    {"wide contact", RayDistribution::Promise::none, draw_wide_contact, 10'000, 20'000, 8'000},
};

}  // namespace lostbits::test
