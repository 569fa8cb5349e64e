// Changes a scene along an axis: its distance, its size or its position in the world. A sweep of offsets runs over such
// scenes.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "scene/file/scene.hpp"

namespace lostbits::measure::offset {

/// Axes of a sweep with the factor k, each a function of scene/file/stretch.hpp: `distance` is `move_farther` by
/// k, `radius` is `enlarge` by k, and `world` is `translate` by k·(1, 0.6875, −0.4375).
enum class SceneAxis { distance, radius, world };
inline constexpr std::array<std::string_view, 3> scene_axis_names{"distance", "radius", "world"};
inline constexpr std::string_view name_of(SceneAxis axis) { return scene_axis_names[static_cast<std::size_t>(axis)]; }
inline constexpr std::array<std::string_view, 3> scene_axis_meanings{
    "times as far away, with the same picture", "times every length of the scene",
    "everything moved by this many times (1, 0.6875, -0.4375)"};
/// Meaning of the factor k, for plots and tables.
inline constexpr std::string_view meaning_of(SceneAxis axis) {
    return scene_axis_meanings[static_cast<std::size_t>(axis)];
}

/// Returns the values of k, which are powers of two: distance 1 to 2^13, radius 2^-12 to 2^24, world 2^-2 to 2^22.
std::vector<double> factors_along(SceneAxis axis);

/// Returns the scene at factor k. Its picture is reduced to 48 columns, because a sweep has many scenes. Throws
/// InputError if the scene cannot be changed along the axis.
scene::file::Scene move_along(const scene::file::Scene& scene, SceneAxis axis, double factor);

}  // namespace lostbits::measure::offset
