// Random rays at tubes.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::tube {

/// `size` is about half of the height. The radius is between a sixteenth of `size` and all of it.
struct TubeFamily : rays::AimedFamily<TubeFamily> {
    static constexpr std::string_view table = "tube_family";

    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> half = size * rays::draw_direction(random);
        return Tube<double>{middle - half, middle + half, size * random.between(0.0625, 1)};
    }
};

}  // namespace lostbits::scene::tube
