// Random rays at tubes.
#pragma once

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::tube {

/// `size` is about half of the height. The radius is between a sixteenth of `size` and all of it.
struct TubeDistribution : rays::AimedDistribution<TubeDistribution> {
    static constexpr std::string_view table = "tube_rays";
    enum Aim { wall, rim, wall_line, axis };
    static constexpr std::pair<std::string_view, int> aims[] = {
        {"wall", wall}, {"rim", rim}, {"generator", wall_line}, {"axis", axis}};

    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> half = size * rays::draw_direction(random);
        return Tube<double>{middle - half, middle + half, size * random.between(0.0625, 1)};
    }
    /// Draws a target: a point of the wall, a point of the rim at one of its ends, a line in the wall, or the axis.
    static rays::AimedPlace draw_target(rays::Random& random, const Primitive<double>& primitive, int aim) {
        if (aim == wall) return rays::AimedDistribution<TubeDistribution>::draw_target(random, primitive, aim);
        const Tube<double> t = primitive.tube();
        const Vec<double> axis_direction = random.sign() * (t.top - t.bottom),
                          end = random.below(2) == 0 ? t.bottom : t.top;
        if (aim == axis) return {end, axis_direction};
        const Vec<double> rim_point = end + t.radius * rays::draw_perpendicular(random, axis_direction);
        return aim == rim ? rays::AimedPlace(rim_point) : rays::AimedPlace(rim_point, axis_direction);
    }
};

}  // namespace lostbits::scene::tube
