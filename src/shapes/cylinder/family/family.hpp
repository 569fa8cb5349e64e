// Random rays at cylinders.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::cylinder {

/// `size` is about half of the height. The radius is between a sixteenth of `size` and all of it.
struct CylinderFamily : rays::AimedFamily<CylinderFamily> {
    static constexpr std::string_view table = "cylinder_family";

    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> half = size * rays::draw_direction(random);
        return Cylinder<double>{middle - half, middle + half, size * random.between(0.0625, 1)};
    }
    /// Draws a point of the largest square bar inside.
    static Vec<double> aimed_at(rays::Random& random, const Solid<double>& solid, int /*aim*/) {
        const double x = random.unit(), y = random.between(0.15, 0.85), z = random.between(0.15, 0.85);
        return solid.cylinder().point_at({x, y, z});
    }
};

}  // namespace lostbits::scene::cylinder
