// Finds which points are in shadow, by a form's own decision.
#pragma once

#include <cstdint>
#include <vector>

#include "measure/truth/band.hpp"

namespace lostbits::measure::render {

/// Shadow rays in one format, one for each point. `reach[i]` is the t of the light on ray i: 1 if the direction is the
/// whole way to the light, and the distance if the direction is normalised. `departed_sphere[i]` is the index of the
/// sphere that ray i leaves, or −1 if it leaves none.
struct ShadowRays {
    scene::rays::RayBlock rays;
    std::vector<double> reach;
    std::vector<std::int32_t> departed_sphere;

    void add(const Vec<double>& origin, const Vec<double>& direction, double light_t,
             std::int32_t departed_sphere_index);
};

/// Bits of the result of `find_blockers` for a ray.
enum Blocker : std::uint8_t { blocked_by_nothing = 0, blocked_by_other = 1, blocked_by_departed_sphere = 2 };

/// Finds which rays are blocked. A primitive of `inputs` (in numbers of the format) blocks a ray if the form reports a
/// hit at 0 < t < reach. A hit at NaN blocks nothing, because every comparison with NaN is false. With
/// `tests_departed_sphere`, a ray is also tested against the sphere that it leaves.
std::vector<std::uint8_t> find_blockers(const intersect::table::Intersector& form, const Format& format,
                                        const ShadowRays& shadow, const truth::FormatInputs& inputs,
                                        bool tests_departed_sphere);

}  // namespace lostbits::measure::render
