// Moves a scene along an axis, over which its offsets are swept.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "scene/file/scene.hpp"

namespace lostbits::measure::offset {

/// Axes, as in scene/file/stretch.hpp. `distance`: `farther`, k times; `radius`: `enlarged`, k times; `world`: `moved`
/// by k·(1, 0.6875, −0.4375).
enum class SceneAxis { distance, radius, world };
inline constexpr std::array<std::string_view, 3> scene_axis_names{"distance", "radius", "world"};
inline constexpr std::string_view name_of(SceneAxis a) { return scene_axis_names[static_cast<std::size_t>(a)]; }
inline constexpr std::array<std::string_view, 3> scene_axis_meanings{
    "times as far away, with the same picture", "times every length of the scene",
    "everything moved by this many times (1, 0.6875, -0.4375)"};
/// Meaning of k, for axes and tables.
inline constexpr std::string_view meaning_of(SceneAxis a) { return scene_axis_meanings[static_cast<std::size_t>(a)]; }

/// The values of k, powers of two: distance 1 to 2^13, radius 2^-12 to 2^24, world 2^-2 to 2^22.
std::vector<double> factors_along(SceneAxis a);

/// Scene at that k, with its picture cut down to 48 columns, since there are many steps. InputError where its camera
/// has no distance.
scene::file::Scene moved_along(const scene::file::Scene& scene, SceneAxis a, double k);

}  // namespace lostbits::measure::offset
