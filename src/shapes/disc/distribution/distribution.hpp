// Random rays at discs.
#pragma once

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::disc {

/// `size` is the outer radius. Half of the discs are annuli.
struct DiscDistribution : rays::AimedDistribution<DiscDistribution> {
    static constexpr std::string_view table = "disc_rays";
    enum Aim { inside, rim, plane };
    static constexpr std::pair<std::string_view, int> aims[] = {{"inside", inside}, {"rim", rim}, {"plane", plane}};

    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> normal = rays::draw_direction(random);
        const double fraction = random.between(-0.75, 0.75);
        return Disc<double>{middle, normal, size, fraction > 0 ? fraction * size : 0};
    }
    /// Draws a point of the disc, a point of a rim (the outer one, or that of the hole), or a line in its plane.
    static rays::AimedPlace draw_target(rays::Random& random, const Primitive<double>& primitive, int aim) {
        const rays::AimedPlace plane_point =
            rays::AimedDistribution<DiscDistribution>::draw_target(random, primitive, aim);
        if (aim == inside) return plane_point;
        const Disc<double> d = primitive.disc();
        const Vec<double> across = rays::draw_perpendicular(random, d.normal);
        if (aim == plane) return {plane_point.point, across};
        return d.centre + (d.inner_radius > 0 && random.below(2) == 0 ? d.inner_radius : d.outer_radius) * across;
    }
};

}  // namespace lostbits::scene::disc
