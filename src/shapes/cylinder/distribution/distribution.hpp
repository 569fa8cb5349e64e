// Random rays at cylinders.
#pragma once

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::cylinder {

/// `size` is about half of the height. The radius is between a sixteenth of `size` and all of it.
struct CylinderDistribution : rays::AimedDistribution<CylinderDistribution> {
    static constexpr std::string_view table = "cylinder_rays";
    enum Aim { inside, rim, side_line, axis };
    static constexpr std::pair<std::string_view, int> aims[] = {
        {"inside", inside}, {"rim", rim}, {"generator", side_line}, {"axis", axis}};

    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> half = size * rays::draw_direction(random);
        return Cylinder<double>{middle - half, middle + half, size * random.between(0.0625, 1)};
    }
    /// Draws a target: a point of the largest square bar inside, a point of the circle in which a cap and the side
    /// meet, a line in the side, or the axis.
    static rays::AimedPlace draw_target(rays::Random& random, const Primitive<double>& primitive, int aim) {
        if (aim != inside) {
            const Cylinder<double> c = primitive.cylinder();
            const Vec<double> axis_direction = random.sign() * (c.top - c.base),
                              end = random.below(2) == 0 ? c.base : c.top;
            if (aim == axis) return {end, axis_direction};
            const Vec<double> rim_point = end + c.radius * rays::draw_perpendicular(random, axis_direction);
            return aim == rim ? rays::AimedPlace(rim_point) : rays::AimedPlace(rim_point, axis_direction);
        }
        const double x = random.unit(), y = random.between(0.15, 0.85), z = random.between(0.15, 0.85);
        return primitive.cylinder().point_at({x, y, z});
    }
};

}  // namespace lostbits::scene::cylinder
