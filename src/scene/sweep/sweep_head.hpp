// What the files of sweeps have in common: how they begin, their axes, by whose convention forms are judged, the scenes
// that they name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "intersect/info.hpp"
#include "scene/file/scene.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::sweep {

inline constexpr std::string_view sweep_schema = "lostbits-sweep/1";

/// What every file of a sweep says of itself; `id` is the file's stem.
struct SweepHead {
    std::string id, title, source, note;
};

/// Reads the head of a file at `path`. InputError with a position where it is of another kind, or has no title or
/// source.
SweepHead read_sweep_head(toml::TableReader& file, const std::filesystem::path& path);

struct AxisName {
    std::string name;        ///< column and label: `distance_over_radius`
    std::string unit;        ///< of its values; may be empty
    std::string label;       ///< what plots call it, in words and with its unit: `distance, in radii`
    toml::Where where = {};  ///< of its name
};

/// InputError where the name cannot be that of a column.
AxisName read_axis_name(toml::TableReader& axis);

/// `closed`: touching is a hit; `open`: it is a miss (`intersect::convention_name` writes them); nothing for another
/// word.
std::optional<intersect::Touching> convention_named(std::string_view word);

/// The key `convention` of a table: one of the two words. Nothing where it is missing.
std::optional<intersect::Touching> read_convention(toml::TableReader& table);

/// The scene that the key `scene` of a table names: a file beside the table's own, or one of the data folder.
/// InputError with its place where there is none.
file::SceneName find_scene_of(const toml::TableReader& table, const std::string& name,
                              const std::filesystem::path& data_dir);

/// That of the key `scene`, looked up in `data_dir`. InputError with a position where it has variants and none is
/// named, and where it has anything but meshes whose vertices stand where they are, the same in every format.
file::Scene read_mesh_scene(toml::TableReader& table, const std::filesystem::path& data_dir,
                            intersect::process::StopToken stop);

}  // namespace lostbits::scene::sweep
