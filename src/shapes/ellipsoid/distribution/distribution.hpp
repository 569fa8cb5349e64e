// Random rays at ellipsoids.
#pragma once

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::ellipsoid {

/// Each radius is between a quarter of `size` and all of it.
struct EllipsoidDistribution : rays::AimedDistribution<EllipsoidDistribution> {
    static constexpr std::string_view table = "ellipsoid_rays";

    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double size) {
        const double x = random.between(0.25, 1), y = random.between(0.25, 1), z = random.between(0.25, 1);
        return Ellipsoid<double>{middle, {size * x, size * y, size * z}};
    }
    /// Draws a point of the largest box inside.
    static rays::AimedPlace draw_target(rays::Random& random, const Primitive<double>& primitive, int /*aim*/) {
        const double x = random.between(0.22, 0.78), y = random.between(0.22, 0.78), z = random.between(0.22, 0.78);
        return primitive.ellipsoid().point_at({x, y, z});
    }
};

}  // namespace lostbits::scene::ellipsoid
