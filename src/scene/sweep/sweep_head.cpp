#include "scene/sweep/sweep_head.hpp"

#include <algorithm>

#include "number/error.hpp"
#include "scene/toml/file_names.hpp"

namespace lostbits::scene::sweep {

SweepHead read_sweep_head(toml::TableReader& file, const std::filesystem::path& path) {
    toml::require_schema(file, sweep_schema);
    return {.id = toml::result_name(path),
            .title = file.title("title"),
            .source = file.string("source"),
            .note = file.optional_string("note").value_or("")};
}

namespace {

using intersect::convention_name;
using intersect::Touching;

constexpr std::pair<std::string_view, Touching> conventions[] = {{convention_name(Touching::hit), Touching::hit},
                                                                 {convention_name(Touching::miss), Touching::miss}};

/// Returns `distance, in radii` for `distance_radii`: a unit at the end of the name is not repeated.
std::string default_label(std::string name, const std::string& unit) {
    const std::string plural = unit == "r" ? "radii" : unit;
    if (!unit.empty() && name.ends_with("_" + plural)) name.resize(name.size() - plural.size() - 1);
    std::ranges::replace(name, '_', ' ');
    return unit.empty() || unit == "1" ? name : name + ", in " + plural;
}

}  // namespace

AxisName read_axis_name(toml::TableReader& axis) {
    AxisName axis_name{axis.string("name"), axis.optional_string("unit").value_or(""), "", axis.where("name")};
    const bool is_plain = !axis_name.name.empty() && std::ranges::all_of(axis_name.name, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
    if (!is_plain)
        axis.fail_at("name", "must be a column name of lower-case letters, digits and _, such as \"distance_radii\"");
    axis_name.label = axis.has("label") ? axis.title("label") : default_label(axis_name.name, axis_name.unit);
    return axis_name;
}

std::optional<Touching> convention_named(std::string_view name) {
    for (const auto& [known_name, touching] : conventions)
        if (known_name == name) return touching;
    return std::nullopt;
}

std::optional<Touching> read_convention(toml::TableReader& table) {
    return table.optional_one_of<Touching>("convention", conventions);
}

file::SceneName find_scene_of(const toml::TableReader& table, const std::string& name,
                              const std::filesystem::path& data_dir) {
    try {
        return file::find_scene(file::resolve_beside(table.where().source, name), data_dir);
    } catch (const InputError& error) {
        table.fail_at("scene", std::string("cannot be found: ") + error.what());
    }
}

file::Scene read_mesh_scene(toml::TableReader& table, const std::filesystem::path& data_dir,
                            intersect::process::StopToken stop) {
    const file::SceneName name = find_scene_of(table, table.string("scene"), data_dir);
    const auto scenes = file::load_scene(name.path, {.variant = name.variant, .stop = stop});
    const file::Scene& scene = scenes.front();
    if (scenes.size() > 1) table.fail_at("scene", "has variants; name one, such as \"" + scene.id + "\"");
    if (!scene.mesh || scene.primitive_count() != scene.mesh->faces.size())
        table.fail_at("scene", "has no mesh, or has other primitives too; name a scene that has only meshes");
    if (scene.mesh_transform) table.fail_at("scene", "has a mesh with a transform; name a scene whose mesh has none");
    if (scene.inputs != file::InputRounding::shared)
        table.fail_at("scene", "has inputs = \"own\"; name a scene whose vertices are the same in every format");
    return scene;
}

}  // namespace lostbits::scene::sweep
