// Random rays at tori.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::torus {

/// `size` is the distance from the centre to the farthest point. The minor radius is between one and fifteen
/// sixteenths of the major one.
struct TorusFamily : rays::AimedFamily<TorusFamily> {
    static constexpr std::string_view table = "torus_family";

    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> axis = rays::draw_direction(random);
        const double major = size / (1 + random.between(0.0625, 0.9375));
        return Torus<double>{middle, axis, major, size - major};
    }
};

}  // namespace lostbits::scene::torus
