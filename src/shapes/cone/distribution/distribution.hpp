// Random rays at cones.
#pragma once

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::cone {

/// `size` is about half of the height. The radius at the base is between a sixteenth of `size` and all of it. The
/// radius at the top is below that, and 0 for one cone in four.
struct ConeDistribution : rays::AimedDistribution<ConeDistribution> {
    static constexpr std::string_view table = "cone_rays";
    enum Aim { inside, rim, apex, side_line, axis };
    static constexpr std::pair<std::string_view, int> aims[] = {
        {"inside", inside}, {"rim", rim}, {"apex", apex}, {"generator", side_line}, {"axis", axis}};

    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> half = size * rays::draw_direction(random);
        const double radius = size * random.between(0.0625, 1), fraction = random.between(-1.0 / 3, 1);
        return Cone<double>{middle - half, middle + half, radius, fraction > 0 ? fraction * radius : 0};
    }
    /// Draws a target: a point of the largest square frustum inside, a point of the circle in which a cap and the side
    /// meet, the apex (or the middle of the top of a cone without apex), a line in the side, or the axis.
    static rays::AimedPlace draw_target(rays::Random& random, const Primitive<double>& primitive, int aim) {
        if (aim != inside) {
            const Cone<double> c = primitive.cone();
            const Vec<double> axis_direction = random.sign() * (c.top - c.base),
                              across = rays::draw_perpendicular(random, axis_direction);
            const Vec<double> below = c.base + c.base_radius * across, above = c.top + c.top_radius * across;
            const bool at_top = random.below(2) == 0;
            switch (aim) {
                case apex: return c.top;
                case axis: return {at_top ? c.top : c.base, axis_direction};
                case side_line: return {at_top ? above : below, random.sign() * (above - below)};
                default: return at_top && c.top_radius > 0 ? above : below;
            }
        }
        const double x = random.unit(), y = random.between(0.15, 0.85), z = random.between(0.15, 0.85);
        return primitive.cone().point_at({x, y, z});
    }
};

}  // namespace lostbits::scene::cone
