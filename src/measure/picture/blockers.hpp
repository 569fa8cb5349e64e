// Finds what stands between points and the light, by a form's own decision.
#pragma once

#include <cstdint>
#include <vector>

#include "measure/truth/band.hpp"

namespace lostbits::measure::picture {

/// Shadow rays in one format, one a point. `reach[i]` is the light's t on ray i (1 where the direction is the whole way
/// to the light, the distance where it was normalised). `left_sphere[i]` is the sphere that ray i leaves (−1: none).
struct ShadowRays {
    scene::rays::RayBlock rays;
    std::vector<double> reach;
    std::vector<std::int32_t> left_sphere;

    void add(const Vec<double>& origin, const Vec<double>& direction, double light_t, std::int32_t leaves);
};

/// Bits of the result of `find_blockers` for a ray.
enum Blocked : std::uint8_t { blocked_by_nothing = 0, blocked_by_other = 1, blocked_by_left_sphere = 2 };

/// Finds which rays are blocked. A primitive of `among` (in numbers of the format) blocks a ray where the form decides
/// on a hit at 0 < t < reach. A hit at NaN blocks nothing: every comparison with it is false. With `tests_left_sphere`,
/// a ray is also tested against the sphere that it leaves.
std::vector<std::uint8_t> find_blockers(const intersect::table::Intersector& form, const Format& format,
                                        const ShadowRays& shadow, const truth::FormatInputs& among,
                                        bool tests_left_sphere);

}  // namespace lostbits::measure::picture
