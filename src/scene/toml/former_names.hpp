// Names of earlier versions that files may still use, with their current names.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace lostbits::scene::toml {

/// Columns of tables and values of keys: the former name and the current name. CHANGELOG.md lists them for users.
inline constexpr std::array<std::pair<std::string_view, std::string_view>, 3> former_names{
    {{"wrong_object", "wrong_primitive"},
     {"wrong_object_fraction", "wrong_primitive_fraction"},
     {"many_rays_one_solid", "many_rays_one_primitive"}}};

/// Tables of sweep files.
inline constexpr std::array<std::pair<std::string_view, std::string_view>, 11> former_tables{
    {{"family", "sphere_rays"},
     {"box_family", "box_rays"},
     {"triangle_family", "triangle_rays"},
     {"ellipsoid_family", "ellipsoid_rays"},
     {"cylinder_family", "cylinder_rays"},
     {"capsule_family", "capsule_rays"},
     {"tube_family", "tube_rays"},
     {"cone_family", "cone_rays"},
     {"disc_family", "disc_rays"},
     {"plane_family", "plane_rays"},
     {"torus_family", "torus_rays"}}};

/// Returns the current name for a former name, and every other text unchanged.
constexpr std::string_view current_name(std::string_view name) {
    const auto found = std::ranges::find(former_names, name, [](const auto& pair) { return pair.first; });
    return found == former_names.end() ? name : found->second;
}

/// Returns the current name for a former key of a file or of a path in a file, and every other key unchanged.
constexpr std::string_view current_table_name(std::string_view key) {
    const auto found = std::ranges::find(former_tables, key, [](const auto& pair) { return pair.first; });
    return found == former_tables.end() ? key : found->second;
}

}  // namespace lostbits::scene::toml
