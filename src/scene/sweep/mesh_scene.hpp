// The scene of a sweep that is about a mesh alone.
#pragma once

#include <filesystem>
#include <string>

#include "scene/file/scene.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::sweep {

/// The scene that the key `scene` of a table names: a file beside the table's own, or one of the data folder.
/// InputError with its place where there is none.
file::SceneName find_scene_of(const toml::TableReader& table, const std::string& name,
                              const std::filesystem::path& data_dir);

/// That of the key `scene`, looked up in `data_dir`. InputError with a position where it has variants and none is
/// named, and where it has anything but meshes whose vertices stand where they are, the same in every format.
file::Scene read_mesh_scene(toml::TableReader& table, const std::filesystem::path& data_dir);

}  // namespace lostbits::scene::sweep
