// The sphereflake of Haines' standard procedural databases: a sphere, and nine of a third of its size on it, and so on.
#pragma once

#include <functional>

#include "intersect/process/stop_token.hpp"
#include "scene/toml/toml_reader.hpp"
#include "shapes/solid.hpp"

namespace lostbits::scene::sphere {

/// A sphere with `levels` generations on it: (9^(levels + 1) − 1)/8 spheres. Each sphere of radius r, whose axis is w,
/// carries nine of radius r/3 that touch it from outside: six around its equator, at 60° from each other, and three at
/// the height √(2/3) above it, at 120°. The axis of a child points away from its parent; u = e × w/|e × w| is where
/// angles start, with e the x axis, or the y axis where |w.x| > 0.8; v = w × u.
struct Sphereflake {
    static constexpr Shape shape = Shape::sphere;
    int levels = 0;
    Vec<double> centre{0, 0, 0};
    double radius = 1;
    Vec<double> axis{0, 0, 1};                ///< of the largest sphere; of any length but zero
    intersect::process::StopToken stop = {};  ///< of who loaded it: asked at every sphere that grows

    [[nodiscard]] std::size_t size() const;
};

/// Levels 0 to 9 (9 has 436 million spheres).
inline constexpr int most_flake_levels = 9;

/// Reads `[sphereflake]`: levels, and perhaps centre, radius > 0 and axis, as binary64. InputError with a position.
Sphereflake read_sphereflake(toml::TableReader table);

/// EnvironmentError where that many spheres need more memory than three quarters of what this machine has: 40 bytes
/// each, with own inputs and some formats (a map in binary32 takes 18 to 20).
void require_room_for(const Sphereflake& flake);

/// Every sphere, parents before their children, in the same order always. In binary64, by + − × ÷ √ alone: the same
/// numbers on every machine. They are the ideal numbers of the scene.
void for_each_solid(const Sphereflake& flake, const std::function<void(const Solid<double>&)>& take);

}  // namespace lostbits::scene::sphere
