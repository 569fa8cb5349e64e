#include "scene/sweep/mesh_scene.hpp"

#include <string>

#include "number/error.hpp"

namespace lostbits::scene::sweep {

file::SceneName find_scene_of(const toml::TableReader& table, const std::string& name,
                              const std::filesystem::path& data_dir) {
    try {
        return file::find_scene(file::beside(table.where().source, name), data_dir);
    } catch (const InputError& error) {
        table.fail_at("scene", std::string("cannot be found: ") + error.what());
    }
}

file::Scene read_mesh_scene(toml::TableReader& table, const std::filesystem::path& data_dir) {
    const file::SceneName name = find_scene_of(table, table.string("scene"), data_dir);
    const auto scenes = file::load_scene(name.path, {.variant = name.variant});
    const file::Scene& scene = scenes.front();
    if (scenes.size() > 1) table.fail_at("scene", "has variants; name one, such as \"" + scene.id + "\"");
    if (!scene.mesh || scene.solid_count() != scene.mesh->faces.size())
        table.fail_at("scene", "has no mesh, or other solids beside it; name a scene of meshes alone");
    if (scene.mesh_placed)
        table.fail_at("scene", "has its mesh under a matrix; name one whose vertices stand where they are");
    if (scene.inputs != file::Inputs::shared)
        table.fail_at("scene", "has inputs = \"own\"; name one whose vertices are the same in every format");
    return scene;
}

}  // namespace lostbits::scene::sweep
