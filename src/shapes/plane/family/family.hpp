// Random rays at planes.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::plane {

struct PlaneFamily : rays::AimedFamily<PlaneFamily> {
    static constexpr std::string_view table = "plane_family";

    /// Draws a plane, which has no size of its own.
    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double /*size*/) {
        return Plane<double>{middle, rays::draw_direction(random)};
    }
};

}  // namespace lostbits::scene::plane
