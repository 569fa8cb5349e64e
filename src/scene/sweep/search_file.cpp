#include "scene/sweep/search_file.hpp"

#include <algorithm>
#include <cmath>

#include "scene/sweep/distributions.hpp"

namespace lostbits::scene::sweep {

using toml::TableReader;

namespace {

/// Reads a file and applies changes to its one table. The paths of the changes need not name the table.
toml::Node read_with_changes(const std::filesystem::path& path, const std::string& table,
                             std::vector<toml::Override> changes) {
    toml::Node root = toml::read_toml(path);
    for (toml::Override& change : changes) {
        if (!change.path.starts_with(table)) change.path = table + change.path;
        toml::apply_override(root, change);
    }
    return root;
}

}  // namespace

SearchedRange read_range(TableReader& table, std::string_view key) {
    const auto ends = table.numbers(key, 2);
    const SearchedRange range{static_cast<double>(ends[0]), static_cast<double>(ends[1])};
    if (!(range.low <= range.high)) table.fail_at(key, "must be [low, high] with low <= high");
    return range;
}

double distance_in_radii(const Ray<double>& ray, const Primitive<double>& primitive) {
    const auto [centre, radius] = ball_around(primitive);
    return length(ray.origin - centre) / radius;
}

SearchFile::SearchFile(const std::filesystem::path& path, const std::vector<toml::Override>& changes) {
    const toml::Node root = read_with_changes(path, "search.", changes);
    TableReader file(root);
    static_cast<SweepHead&>(*this) = read_sweep_head(file, path);

    TableReader table = file.table("search");
    read_ranges(table);
    read_drawing(table);
    read_goal(table);
    table.require_known_keys();
    file.require_known_keys();
}

/// Reads the ranges of the ray's numbers, then those of a primitive, whose keys tell its shape.
void SearchFile::read_ranges(TableReader& table) {
    const auto read_three_ranges = [&](std::string_view key) {
        ranges.insert(ranges.end(), 3, read_range(table, key));
    };
    read_three_ranges("origin");
    read_three_ranges("direction");

    // The shape whose first key and most other keys are present. If no first key is present, it may be misspelt.
    const auto key_counts = [&table](const ShapeRow& shape_row) {
        const auto is_present = [&table](const Key& key) { return table.has(key.name); };
        return std::pair(is_present(shape_row.keys.front()), std::ranges::count_if(shape_row.keys, is_present));
    };
    shape = std::ranges::max(shape_rows, {}, key_counts).shape;  // and the first shape if several are equal
    for (const Key& key : row_of(shape).keys) {
        if (key.count() == 3) read_three_ranges(key.name);
        else ranges.push_back(read_range(table, key.name));
    }

    if (is_round()) {
        if (table.has("distance_radii")) distance_radii = read_range(table, "distance_radii");
        if (table.has("impact_radii")) impact_radii = read_range(table, "impact_radii");
    }
}

/// Reads how the numbers of a ray are drawn.
void SearchFile::read_drawing(TableReader& table) {
    if (table.has("exponents")) {
        exponents = read_range(table, "exponents");
        for (const double end : {exponents->low, exponents->high}) {
            if (end != std::rint(end) || !(std::fabs(end) <= 1074))
                table.fail_at("exponents",
                              "must be two whole numbers from -1074 to 1074, the binary exponents of its numbers");
        }
    }

    table.read("at_edge", at_edge);
    if (at_edge && !row_of(shape).has_edges)
        table.reject("at_edge", "needs a box, because rays are aimed at its edges; leave it out");
    if (table.has("aim")) read_aim(table);
}

/// Reads what the search looks for, and how long.
void SearchFile::read_goal(TableReader& table) {
    table.read("metric", metric);
    table.read("seed", seed, 0, 1LL << 53);
    table.read("starts", start_count, 1, 4096);
    table.read("generations", generation_count, 1, 65536);

    table.read("nearest", nearest);
    if (nearest && !is_round())
        table.reject("nearest",
                     "needs a sphere, because it minimises the distance to the centre in radii; leave it out");

    table.read("smallest", is_minimised);
    table.read("hits_only", hits_only);
    hits_only = hits_only || is_minimised;
    if (hits_only && nearest)
        table.reject(is_minimised ? "smallest" : "hits_only",
                     "cannot be combined with nearest, which is about wrong decisions; leave one out");
}

void SearchFile::read_aim(TableReader& table) {
    const auto aims = std::ranges::find(distributions(), shape, &DistributionRow::shape)->aims;
    const std::string plural = std::string(row_of(shape).plural);
    if (aims.empty()) table.reject("aim", "names a place, and " + plural + " have none; leave it out");
    aim = table.one_of("aim", aims);
    if (at_edge || exponents)
        table.reject("aim", "places the ray by itself, as at_edge and exponents do; leave one of them out");
    if (table.has("distance")) distance = read_range(table, "distance");
    if (!(distance.low > 0 && distance.high <= 0x1p60))
        table.fail_at("distance", "must lie above 0 and up to 2^60, in halves of the size of the primitive");
}

bool SearchFile::contains(const Ray<double>& ray, const Primitive<double>& primitive) const {
    std::size_t i = 0;
    for (const Vec<double>& v : {ray.origin, ray.direction}) {
        for (int k = 0; k < 3; ++k) {
            if (!ranges[i++].contains(v[k])) return false;
        }
    }
    for (const double x : primitive.shape_numbers()) {
        if (!ranges[i++].contains(x)) return false;
    }
    if (!is_round()) return !broken_limit(primitive) && ray.direction != Vec<double>(0, 0, 0);
    const auto [centre, radius] = ball_around(primitive);
    const Vec<double> f = ray.origin - centre;
    const double impact = length(cross(f, ray.direction)) / length(ray.direction);
    return distance_radii.contains(distance_in_radii(ray, primitive)) && impact_radii.contains(impact / radius);
}

EdgeSearchFile::EdgeSearchFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
                               const std::vector<toml::Override>& changes, intersect::process::StopToken stop) {
    const toml::Node root = read_with_changes(path, "edge_search.", changes);
    TableReader file(root);
    static_cast<SweepHead&>(*this) = read_sweep_head(file, path);
    TableReader table = file.table("edge_search");
    scene = read_mesh_scene(table, data_dir, stop);
    if (triangle::find_shared_edges(*scene.mesh).empty())
        table.fail_at("scene", "has a mesh in which no two triangles share an edge; name another scene");
    if (table.has("distance")) distance = read_range(table, "distance");
    if (!(distance.low > 0 && distance.high <= 0x1p60))
        table.fail_at("distance", "must lie above 0 and up to 2^60, in lengths of an edge");
    table.read("ulps", ulps, 0, 1024);
    table.read("seed", seed, 0, 1LL << 53);
    table.read("rays", ray_count, 1, 1LL << 40);
    table.read("census", census_ray_count, 0, 1LL << 40);
    table.require_known_keys();
    file.require_known_keys();
}

}  // namespace lostbits::scene::sweep
