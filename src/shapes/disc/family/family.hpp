// Random rays at discs.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::disc {

/// `size` is the outer radius. Half of the discs are annuli.
struct DiscFamily : rays::AimedFamily<DiscFamily> {
    static constexpr std::string_view table = "disc_family";

    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> normal = rays::draw_direction(random);
        const double share = random.between(-0.75, 0.75);
        return Disc<double>{middle, normal, size, share > 0 ? share * size : 0};
    }
};

}  // namespace lostbits::scene::disc
