#include "scene/sweep/edge_search_file.hpp"

#include "scene/sweep/mesh_scene.hpp"

namespace lostbits::scene::sweep {

using toml::TableReader;

EdgeSearchFile::EdgeSearchFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
                               const std::vector<toml::Override>& set) {
    toml::Node root = toml::read_toml(path);
    for (toml::Override change : set) {
        if (!change.path.starts_with("edge_search.")) change.path = "edge_search." + change.path;
        toml::apply_override(root, change);
    }
    TableReader file(root);
    static_cast<SweepHead&>(*this) = read_sweep_head(file, path);
    TableReader table = file.table("edge_search");
    scene = read_mesh_scene(table, data_dir);
    if (triangle::shared_edges(*scene.mesh).empty())
        table.fail_at("scene", "has a mesh of which no two triangles share an edge; name another");
    if (table.has("distance")) distance = read_range(table, "distance");
    if (!(distance.low > 0 && distance.high <= 0x1p60))
        table.fail_at("distance", "must lie above 0 and up to 2^60, in lengths of an edge");
    ulps = static_cast<int>(table.optional_integer("ulps", 0, 1024).value_or(ulps));
    seed = static_cast<std::uint64_t>(table.optional_integer("seed", 0, 1LL << 53).value_or(1));
    rays = table.optional_integer("rays", 1, 1LL << 40).value_or(rays);
    table.reject_unknown_keys();
    file.reject_unknown_keys();
}

}  // namespace lostbits::scene::sweep
