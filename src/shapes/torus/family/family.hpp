// Random rays at tori.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::torus {

/// `size` is how far it reaches from its centre; the minor radius is a sixteenth of the major one up to fifteen of
/// them.
struct TorusFamily : rays::AimedFamily<TorusFamily> {
    static constexpr std::string_view table = "torus_family";

    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> axis = rays::draw_direction(random);
        const double major = size / (1 + random.between(0.0625, 0.9375));
        return Torus<double>{middle, axis, major, size - major};
    }
};

}  // namespace lostbits::scene::torus
