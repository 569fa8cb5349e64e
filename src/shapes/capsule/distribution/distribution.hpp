// Random rays at capsules.
#pragma once

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::capsule {

/// `size` is about half of the length of the axis. The radius is between a sixteenth of `size` and all of it.
struct CapsuleDistribution : rays::AimedDistribution<CapsuleDistribution> {
    static constexpr std::string_view table = "capsule_rays";
    enum Aim { inside, seam, side_line, axis };
    static constexpr std::pair<std::string_view, int> aims[] = {
        {"inside", inside}, {"seam", seam}, {"generator", side_line}, {"axis", axis}};

    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> half = size * rays::draw_direction(random);
        return Capsule<double>{middle - half, middle + half, size * random.between(0.0625, 1)};
    }
    /// Draws a target: a point within half a radius of the axis, a point of the circle in which a ball and the side
    /// meet, a line in the side, or the axis.
    static rays::AimedPlace draw_target(rays::Random& random, const Primitive<double>& primitive, int aim) {
        const Capsule<double> c = primitive.capsule();
        if (aim != inside) {
            const Vec<double> axis_direction = random.sign() * (c.end - c.start),
                              end = random.below(2) == 0 ? c.start : c.end;
            if (aim == axis) return {end, axis_direction};
            const Vec<double> rim_point = end + c.radius * rays::draw_perpendicular(random, axis_direction);
            return aim == seam ? rays::AimedPlace(rim_point) : rays::AimedPlace(rim_point, axis_direction);
        }
        const double u = random.unit();
        return c.start + u * (c.end - c.start) + 0.5 * c.radius * rays::draw_direction(random);
    }
};

}  // namespace lostbits::scene::capsule
