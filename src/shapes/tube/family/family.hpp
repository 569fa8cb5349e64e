// Random rays at tubes.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::tube {

/// `size` is half of the height, or nearly; the radius is a sixteenth of it or up to as large.
struct TubeFamily : rays::AimedFamily<TubeFamily> {
    static constexpr std::string_view table = "tube_family";

    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> half = size * rays::draw_direction(random);
        return Tube<double>{middle - half, middle + half, size * random.between(0.0625, 1)};
    }
};

}  // namespace lostbits::scene::tube
