// Random rays at tori.
#pragma once

#include <cmath>

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::torus {

/// `size` is the distance from the centre to the farthest point. The minor radius is between one and fifteen
/// sixteenths of the major one.
struct TorusDistribution : rays::AimedDistribution<TorusDistribution> {
    static constexpr std::string_view table = "torus_rays";
    enum Aim { ring, hole, axis, flat, bitangent };
    static constexpr std::pair<std::string_view, int> aims[] = {
        {"ring", ring}, {"hole", hole}, {"axis", axis}, {"flat", flat}, {"bitangent", bitangent}};

    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double size) {
        const Vec<double> up = rays::draw_direction(random);
        const double major = size / (1 + random.between(0.0625, 0.9375));
        return Torus<double>{middle, up, major, size - major};
    }
    /// Draws a target: a point of the ring's plane; the centre, from any direction or along the axis; a line in the
    /// plane that touches the torus in a circle, tangent to this circle; or a line through the centre that touches the
    /// torus on both sides of the centre. The sine of the last line's angle to the ring's plane is minor/major.
    static rays::AimedPlace draw_target(rays::Random& random, const Primitive<double>& primitive, int aim) {
        if (aim == ring) return rays::AimedDistribution<TorusDistribution>::draw_target(random, primitive, aim);
        const Torus<double> t = primitive.torus();
        const Vec<double> axis_direction = (random.sign() / length(t.axis)) * t.axis,
                          across = rays::draw_perpendicular(random, axis_direction);
        const double sine = t.minor_radius / t.major_radius;
        switch (aim) {
            case hole: return t.centre;
            case axis: return {t.centre, axis_direction};
            case flat:
                return {t.centre + t.minor_radius * axis_direction + t.major_radius * across,
                        cross(axis_direction, across)};
            default: return {t.centre, sine * axis_direction + std::sqrt(1 - sine * sine) * across};
        }
    }
};

}  // namespace lostbits::scene::torus
