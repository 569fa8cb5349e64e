// Random rays at cones.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::cone {

/// `size` is about half of the height. The radius at the base is between a sixteenth of `size` and all of it. The
/// radius at the top is anything below that, and 0 for one cone in four.
struct ConeFamily : rays::AimedFamily<ConeFamily> {
    static constexpr std::string_view table = "cone_family";

    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> half = size * rays::draw_direction(random);
        const double radius = size * random.between(0.0625, 1), share = random.between(-1.0 / 3, 1);
        return Cone<double>{middle - half, middle + half, radius, share > 0 ? share * radius : 0};
    }
    /// Draws a point of the largest square bar inside.
    static Vec<double> aimed_at(rays::Random& random, const Solid<double>& solid, int /*aim*/) {
        const double x = random.unit(), y = random.between(0.15, 0.85), z = random.between(0.15, 0.85);
        return solid.cone().point_at({x, y, z});
    }
};

}  // namespace lostbits::scene::cone
