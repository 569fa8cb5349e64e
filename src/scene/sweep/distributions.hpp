// Table of the ray distributions, one for each shape.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::sweep {

/// Draws the rays of a distribution's table. `seed_offset` is added to its seed.
using Drawer = std::function<std::vector<rays::RayGroup>(std::uint64_t seed_offset)>;

/// The ray distribution of a shape.
struct DistributionRow {
    Shape shape;
    std::string_view table;  ///< the name of its table in sweep files: `sphere_rays`
    /// Throws InputError with a position for anything out of range.
    Drawer (*read)(toml::TableReader);
    std::span<const rays::RaySet> (
        *ray_sets)();                          ///< the easy set first; drawn from fixed seeds, so always the same rays
    rays::HitsAndMisses (*draw_timed_rays)();  ///< rays for timing, like those of the easy set
    /// Targets of the key `aim` by name; none for spheres and planes.
    std::span<const std::pair<std::string_view, int>> aims = {};
    rays::AimedPlace (*draw_target)(rays::Random&, const Primitive<double>&, int aim) = nullptr;
};

/// One row for each shape, in the order of the list.
std::span<const DistributionRow> distributions();

/// Returns the names of all tables of ray distributions: `[sphere_rays], [box_rays] and [cone_rays]`.
std::string distribution_tables_text();

}  // namespace lostbits::scene::sweep
