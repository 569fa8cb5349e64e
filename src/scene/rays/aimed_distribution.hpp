// Ray distribution for any shape: primitives drawn from a seed, and rays aimed at points of these primitives.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/rays/distribution_parts.hpp"

namespace lostbits::scene::rays {

/// Draws a direction of length 1 without sine and cosine, which differ between machines.
inline Vec<double> draw_direction(Random& random) {
    for (;;) {
        // Draw one by one: the compiler chooses the order in which arguments are evaluated, and clang and gcc differ.
        const double x = random.between(-1, 1), y = random.between(-1, 1), z = random.between(-1, 1);
        const Vec<double> d(x, y, z);
        if (const double size = length(d); size <= 1 && size > 0x1p-10) return d / size;
    }
}

/// Draws a direction of length 1 at right angles to v.
inline Vec<double> draw_perpendicular(Random& random, const Vec<double>& v) {
    for (;;) {
        const Vec<double> d = draw_direction(random), across = d - (dot(d, v) / square(v)) * v;
        if (const double size = length(across); size > 0x1p-4) return across / size;
    }
}

/// Target of a ray: a point, and the direction of the ray if the target fixes it.
struct AimedPlace {
    AimedPlace(const Vec<double>& target) : point(target) {}
    AimedPlace(const Vec<double>& target, const Vec<double>& direction)
        : point(target), along((1 / length(direction)) * direction) {}

    Vec<double> point;
    std::optional<Vec<double>> along;  ///< of length 1
};

/// Draws a point of the surface of a primitive.
inline Vec<double> draw_on_surface(Random& random, const Primitive<double>& primitive) {
    return visit(primitive, [&](const auto& shape) {
        const auto draw_point = [&] {
            const double x = random.unit(), y = random.unit(), z = random.unit();
            return shape.point_at({x, y, z});
        };
        Vec<double> inside = draw_point();
        if (!has_inside(primitive.shape)) return inside;
        while (!(shape.distance(inside) < 0)) inside = draw_point();
        Vec<double> outside = inside + 4 * shape.half_extent() * draw_direction(random);
        for (int i = 0; i < 60; ++i) {
            const Vec<double> middle = 0.5 * (inside + outside);
            (shape.distance(middle) < 0 ? inside : outside) = middle;
        }
        return outside;
    });
}

/// Start of the rays of a distribution: away from the primitive, or on the surface of a second primitive of the same
/// kind, as rays to a light and reflected rays do. Once rounded to binary32, such rays begin just inside or just
/// outside of the second primitive.
enum class RayStart : std::uint8_t { away, on_other };
inline constexpr std::pair<std::string_view, RayStart> ray_start_names[] = {{"away", RayStart::away},
                                                                            {"other", RayStart::on_other}};

/// Draws a ray from the surface of `other` to the point `target`, or in the direction `default_direction` if the two
/// points are equal.
template <class F>
Ray<double> ray_from_surface(Random& random, const F& distribution, const Primitive<double>& other,
                             const Vec<double>& target, const Vec<double>& default_direction) {
    const Vec<double> origin = stored(draw_on_surface(random, other));
    const double separation = length(target - origin);
    return {origin, stored(direction_length(distribution) *
                           (separation > 0 ? (target - origin) / separation : default_direction))};
}

/// Base of the ray distribution of a shape. The distribution is a struct F that derives from this one and has the name
/// of a table and
///     static Primitive<double> draw_primitive(Random&, const Vec<double>& middle, double size)
/// It may also have targets:
///     static constexpr std::pair<std::string_view, int> aims[]    values of the key `aim` by name; else aim is 0
///     static AimedPlace draw_target(Random&, const Primitive<double>&, int aim)
/// Rays come from any direction that the target leaves open, from `distance` sizes away. If they begin on another
/// primitive, the middle of that primitive is `distance` sizes away in any direction, and the rays begin anywhere on
/// its surface.
template <class F>
struct AimedDistribution {
    int aim = 0;
    RayStart start = RayStart::away;
    double size = 1;                 ///< approximate size of the primitive, world units
    double distance = 4;             ///< from the eye to the point aimed at, in sizes
    double aside = 0;                ///< distance by which the point is moved, in any direction, in sizes
    double direction_magnitude = 1;  ///< length of the directions, to the nearest power of two
    double offset = 0;               ///< everything is moved by offset·(1, 0.6875, −0.4375)
    int view_count = 1024;           ///< number of primitives; the rays at one primitive form one sample
    int ray_count = 1;               ///< rays per primitive
    std::uint64_t seed = 1;

    /// Reads the table. Throws InputError with a position for anything out of range.
    static F read(toml::TableReader table) {
        F f;
        if constexpr (requires { F::aims; }) table.read("aim", f.aim, F::aims);
        table.read("begin", f.start, ray_start_names);
        table.read_number("size", f.size, 0x1p-100, 0x1p+100);
        table.read_number("distance", f.distance, 0, 0x1p+100);
        table.read_number("aside", f.aside, 0, 0x1p+20);
        read_common_keys(table, f);
        return f;
    }

    /// Draws the rays: shared inputs, each number rounded once to binary32.
    [[nodiscard]] std::vector<RayGroup> draw() const {
        return draw_views(*this, [](Random& random, const AimedDistribution& f) {
            const auto draw_primitive = [&](const Vec<double>& middle) {
                return convert_numbers(F::draw_primitive(random, middle, f.size), [](double x) { return stored(x); });
            };
            const Primitive<double> primitive = draw_primitive(offset_of(f));
            RayGroup group;
            group.primitives.push_back(primitive);
            if (f.start == RayStart::on_other)
                group.primitives.push_back(
                    draw_primitive(offset_of(f) + (f.distance * f.size) * draw_direction(random)));
            for (int i = 0; i < f.ray_count; ++i) {
                const Vec<double> random_direction = draw_direction(random),
                                  shift = (f.aside * f.size) * draw_direction(random);
                const AimedPlace target = F::draw_target(random, primitive, f.aim);
                const Vec<double> point = target.point + shift;
                if (f.start == RayStart::on_other) {
                    group.rays.push(ray_from_surface(random, f, group.primitives[1], point, random_direction));
                    continue;
                }
                const Vec<double> d = target.along.value_or(random_direction);
                group.rays.push({stored(point - (f.distance * f.size) * d), stored(direction_length(f) * d)});
            }
            return group;
        });
    }

    /// Returns a point at random fractions of the sides of the bounding cube.
    static AimedPlace draw_target(Random& random, const Primitive<double>& primitive, int /*aim*/) {
        const double x = random.unit(), y = random.unit(), z = random.unit();
        return visit(primitive, [&](const auto& shape) { return shape.point_at(Vec<double>(x, y, z)); });
    }

    static std::span<const RaySet> ray_sets() {
        static constexpr RaySet ray_sets[] = {
            {"easy", "from 4 sizes away, in any direction", [] { return F{}.draw(); }}};
        return ray_sets;
    }
    /// Rays for timing. The misses point away from the primitive.
    static HitsAndMisses draw_timed_rays() {
        const F distribution = with_single_view(F{});
        HitsAndMisses rays{distribution.draw().front(), distribution.draw().front()};
        for (auto* column : {&rays.misses.rays.dx, &rays.misses.rays.dy, &rays.misses.rays.dz})
            for (double& x : *column) x = -x;
        return rays;
    }
};

}  // namespace lostbits::scene::rays
