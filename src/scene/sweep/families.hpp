// What is drawn at random of each shape.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/rays/family_parts.hpp"

namespace lostbits::scene::sweep {

/// Draws the rays of a family's table, by the seed that many after its own.
using Drawer = std::function<std::vector<rays::RayGroup>(std::uint64_t further)>;

/// The family of a shape.
struct FamilyRow {
    Shape shape;
    std::string_view table;  ///< `family`: of the files of sweeps
    /// InputError with a position for anything out of range.
    Drawer (*read)(toml::TableReader);
    std::span<const rays::RaySet> (*sets)();  ///< the easy one first; seeded: always the same rays
    rays::HitsAndMisses (*timed)();           ///< of the easy kind
};

/// A row a shape, in the order of the list.
std::span<const FamilyRow> families();

/// `a [family] or a [box_family] table`.
std::string tables_of_families();

}  // namespace lostbits::scene::sweep
