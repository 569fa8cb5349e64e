// Random rays at capsules.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::capsule {

/// `size` is about half of the axis. The radius is between a sixteenth of `size` and all of it.
struct CapsuleFamily : rays::AimedFamily<CapsuleFamily> {
    static constexpr std::string_view table = "capsule_family";

    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> half = size * rays::draw_direction(random);
        return Capsule<double>{middle - half, middle + half, size * random.between(0.0625, 1)};
    }
    /// A point within half a radius of the axis.
    static Vec<double> aimed_at(rays::Random& random, const Solid<double>& solid, int /*aim*/) {
        const Capsule<double> c = solid.capsule();
        const double u = random.unit();
        return c.start + u * (c.end - c.start) + 0.5 * c.radius * rays::draw_direction(random);
    }
};

}  // namespace lostbits::scene::capsule
