// Random rays at triangles, aimed at their inside, at edges or at vertices.
#pragma once

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::triangle {

/// Triangles whose vertices are at about the distance `size` from a common point, in random directions. The area is at
/// least size²/8.
struct TriangleDistribution : rays::AimedDistribution<TriangleDistribution> {
    static constexpr std::string_view table = "triangle_rays";
    enum Aim { inside, edge, vertex };
    static constexpr std::pair<std::string_view, int> aims[] = {{"inside", inside}, {"edge", edge}, {"vertex", vertex}};

    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double size) {
        for (;;) {
            const Vec<double> a = rays::draw_direction(random), b = rays::draw_direction(random);
            const Vec<double> c = rays::draw_direction(random), normal = cross(b - a, c - a);
            if (square(normal) < 0x1p-4) continue;
            return Triangle<double>{middle + size * a, middle + size * b, middle + size * c};
        }
    }
    static rays::AimedPlace draw_target(rays::Random& random, const Primitive<double>& primitive, int aim) {
        const Triangle<double> t = primitive.triangle();
        const double u = random.unit(), v = random.unit();
        const Vec<double> corners[] = {t.a, t.b, t.c};
        const int k = random.below(3);
        const Vec<double>&x = corners[k], &y = corners[(k + 1) % 3];
        if (aim == inside) return t.point_at({u, v, 0});
        return aim == vertex ? rays::AimedPlace(x) : rays::AimedPlace(x + u * (y - x));
    }
};

}  // namespace lostbits::scene::triangle
