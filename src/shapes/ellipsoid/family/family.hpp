// Random rays at ellipsoids.
#pragma once

#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::ellipsoid {

/// `size` is the longest radius, or nearly; the others are as long or down to a quarter of it.
struct EllipsoidFamily : rays::AimedFamily<EllipsoidFamily> {
    static constexpr std::string_view table = "ellipsoid_family";

    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        const double x = random.between(0.25, 1), y = random.between(0.25, 1), z = random.between(0.25, 1);
        return Ellipsoid<double>{middle, {size * x, size * y, size * z}};
    }
};

}  // namespace lostbits::scene::ellipsoid
