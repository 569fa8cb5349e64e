// Random rays at planes.
#pragma once

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::plane {

struct PlaneDistribution : rays::AimedDistribution<PlaneDistribution> {
    static constexpr std::string_view table = "plane_rays";

    /// Draws a plane, which has no size of its own.
    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double /*size*/) {
        return Plane<double>{middle, rays::draw_direction(random)};
    }
};

}  // namespace lostbits::scene::plane
