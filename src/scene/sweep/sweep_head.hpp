// How the files of all sweeps begin, and the names of their axes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

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

}  // namespace lostbits::scene::sweep
