// Reads the common parts of sweep files: their head, their axes, the convention by which forms are judged, and the
// scenes that they name.
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

/// The head of every sweep file; `id` is the file's stem.
struct SweepHead {
    std::string id, title, source, note;
};

/// Reads the head of the file at `path`. Throws InputError with a position if the file is of another kind, or has no
/// title or source.
SweepHead read_sweep_head(toml::TableReader& file, const std::filesystem::path& path);

struct AxisName {
    std::string name;                 ///< name of the column: `distance_over_radius`
    std::string unit;                 ///< unit of the values; may be empty
    std::string label;                ///< label in plots, in words and with the unit: `distance, in radii`
    toml::SourcePosition where = {};  ///< position of the name
};

/// Reads the name of an axis. Throws InputError if it is not a valid name of a column.
AxisName read_axis_name(toml::TableReader& axis);

/// Returns the convention with this name. `closed`: touching is a hit; `open`: touching is a miss
/// (`intersect::convention_name` writes these names). Returns nothing for any other name.
std::optional<intersect::Touching> convention_named(std::string_view name);

/// Reads the key `convention` of a table, `closed` or `open`. Returns nothing if the key is missing.
std::optional<intersect::Touching> read_convention(toml::TableReader& table);

/// Finds the scene that the key `scene` of a table names: a file in the folder of the table's file, or a scene of the
/// data folder. Throws InputError with the position of the key if there is no such scene.
file::SceneName find_scene_of(const toml::TableReader& table, const std::string& name,
                              const std::filesystem::path& data_dir);

/// Reads the scene of the key `scene`, looked up in `data_dir`. Throws InputError with a position if it has variants
/// and none is named, or has anything but meshes without a transform whose vertices are the same in every format.
file::Scene read_mesh_scene(toml::TableReader& table, const std::filesystem::path& data_dir,
                            intersect::process::StopToken stop);

}  // namespace lostbits::scene::sweep
