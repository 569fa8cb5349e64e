// The sphereflake of Haines' standard procedural databases: a sphere that carries nine spheres of a third of its size,
// each of which carries nine smaller ones, and so on.
#pragma once

#include <functional>

#include "intersect/process/stop_token.hpp"
#include "scene/toml/toml_reader.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::scene::sphere {

/// A sphere with `levels` generations on it: (9^(levels + 1) − 1)/8 spheres. Each sphere of radius r and axis w
/// carries nine of radius r/3 that touch it from outside: six around its equator, 60° apart, and three at the height
/// √(2/3) above it, 120° apart. The axis of a child points away from its parent. Angles start at u = e × w/|e × w|,
/// where e is the x axis, or the y axis if |w.x| > 0.8; v = w × u.
struct Sphereflake {
    static constexpr Shape shape = Shape::sphere;
    int levels = 0;
    Vec<double> centre{0, 0, 0};
    double radius = 1;
    Vec<double> axis{0, 0, 1};                ///< axis of the largest sphere; any length except zero
    intersect::process::StopToken stop = {};  ///< the loader's token, checked at every sphere that grows

    [[nodiscard]] std::size_t size() const;
};

/// Largest number of levels; it makes 436 million spheres.
inline constexpr int max_flake_levels = 9;

/// Reads `[sphereflake]`: levels, and optionally centre, radius > 0 and axis, as binary64. Throws InputError with a
/// position.
Sphereflake read_sphereflake(toml::TableReader table);

/// Throws EnvironmentError if the spheres need more than three quarters of this machine's memory. The estimate is 40
/// bytes for each sphere, enough for own inputs and several formats (a map in binary32 takes 18 to 20).
void require_memory_for(const Sphereflake& flake);

/// Calls `visit` with every sphere, parents before their children, always in the same order. The numbers are computed
/// in binary64 by + − × ÷ √ alone, so they are the same on every machine. They are the ideal numbers of the scene.
void for_each_primitive(const Sphereflake& flake, const std::function<void(const Primitive<double>&)>& visit);

}  // namespace lostbits::scene::sphere
