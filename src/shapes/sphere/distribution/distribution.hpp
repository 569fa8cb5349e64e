// Random rays at spheres: one sphere and a seeded set of rays around it, with the numbers that a sweep varies.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "scene/rays/aimed_distribution.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::sphere {

/// One sphere seen along directions w = (a, b, c)/n, where a² + b² + c² = n² in whole numbers (Pythagorean quadruples).
/// The distances of a sweep then exist exactly in binary32, in oblique directions too.
struct SphereDistribution {
    static constexpr std::string_view table = "sphere_rays";

    /// parallel: rays along w from a disc around the world's origin. The centre is at M·(a, b, c), where M has 12 bits,
    /// so it is only about `distance` radii away. point: the surface passes through the world's origin exactly. All
    /// rays of a view start at `height` above the origin, and pass the centre at the distances stated below.
    enum class Projection { parallel, point };
    /// oblique: w = (a, b, c)/n. tilted: w ∥ (1, tilt·y, tilt·z) with (y, z) anywhere on the unit circle, the axes in
    /// any order, and components of 12 bits. The distance or the radius is within 1/64 of the requested one. axis: as
    /// tilted with tilt = 0.
    enum class ViewDirections { oblique, axis, tilted };
    enum class Weighting { disc, silhouette };

    Projection projection = Projection::parallel;
    ViewDirections directions = ViewDirections::oblique;
    Weighting weighting = Weighting::disc;
    rays::RayStart start = rays::RayStart::away;  ///< on_other: the other sphere is `distance` radii from the first
    double radius = 1;                            ///< world units
    double distance = 4;                          ///< parallel: eye to centre, in radii
    double height = 1;                            ///< point: eye to surface, world units
    double impact_from = 0;          ///< distance of the line from the centre, in radii. disc: uniform in area between
    double impact_to = 0.999;        ///< these; silhouette: uniform in log2(1 − impact)
    double silhouette_gap = 0;       ///< > 0: all lines pass at 1 − gap radii, in place of the impacts above
    bool away = false;               ///< point: rays along +w, away from the centre
    double direction_magnitude = 1;  ///< length of the directions, to the nearest power of two
    double tilt = 0;                 ///< tilted: tangent of the angle to an axis
    double offset = 0;               ///< everything is moved by offset·(1, 0.6875, −0.4375)
    int view_count = 1024;           ///< directions w, each with a centre; the rays of one view form one sample
    int ray_count = 1;               ///< rays per view
    std::uint64_t seed = 1;

    /// Reads `[sphere_rays]`. Throws InputError with a position if a number is out of range.
    static SphereDistribution read(toml::TableReader table);
    /// Draws the rays: shared inputs, each number rounded once to binary32. The random numbers depend on the seed
    /// alone, so neighbouring steps of a sweep have the same rays in units of the sphere.
    [[nodiscard]] std::vector<rays::RayGroup> draw() const;

    static std::span<const rays::RaySet> ray_sets();
    static rays::HitsAndMisses draw_timed_rays();
};

}  // namespace lostbits::scene::sphere
