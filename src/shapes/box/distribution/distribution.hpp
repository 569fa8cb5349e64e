// Random rays at boxes: seeded, aimed at faces, edges and corners, or past them by a stated gap.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "scene/rays/aimed_distribution.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::box {

/// A box with random sides, and rays that touch it at one point of an edge or a corner, or run along a face. The rays
/// are then moved away from the box by `gap`. With `adjoining`, the box is cut into eight boxes that share three
/// planes, and the rays are aimed at the shared points. The closed boxes fill the space around these points, so each
/// such ray meets one of them. If `start` is on_other, the group has a second box, and the rays start on its surface.
/// They are aimed at the same points, but come from any direction.
struct BoxDistribution {
    static constexpr std::string_view table = "box_rays";
    enum class Aim { face, edge, corner, inside };

    Aim aim = Aim::edge;
    rays::RayStart start = rays::RayStart::away;
    bool adjoining = false;
    double size = 1;                 ///< longest side, world units
    double thickness = 1;            ///< shortest side, in sizes; 0: flat
    double distance = 4;             ///< from the eye to the point aimed at, in sizes
    double gap = 0;                  ///< in sizes; positive: outward, a miss by that much
    double direction_magnitude = 1;  ///< length of the directions, to the nearest power of two
    double offset = 0;               ///< everything is moved by offset·(1, 0.6875, −0.4375)
    int view_count = 1024;           ///< number of boxes; the rays at one box form one sample
    int ray_count = 1;               ///< rays per box
    std::uint64_t seed = 1;

    enum TargetPlace { on_edge, at_corner };
    static constexpr std::pair<std::string_view, int> aims[] = {{"edge", on_edge}, {"corner", at_corner}};
    /// Draws a point of an edge, or a corner, as a target for rays that come from any direction.
    static rays::AimedPlace draw_target(rays::Random& random, const Primitive<double>& primitive, int target);

    /// Reads `[box_rays]`. Throws InputError with a position if a number is out of range.
    static BoxDistribution read(toml::TableReader table);
    /// Draws the rays: shared inputs, each number rounded once to binary32.
    [[nodiscard]] std::vector<rays::RayGroup> draw() const;

    static std::span<const rays::RaySet> ray_sets();
    static rays::HitsAndMisses draw_timed_rays();
};

}  // namespace lostbits::scene::box
