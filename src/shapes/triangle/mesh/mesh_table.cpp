#include <cmath>
#include <new>

#include "number/error.hpp"
#include "scene/toml/round.hpp"
#include "shapes/triangle/mesh/made.hpp"
#include "shapes/triangle/mesh/mesh_file.hpp"

namespace lostbits::scene::triangle {

namespace {

enum class MadeMesh { icosphere, grid, tube, fan };
constexpr std::pair<std::string_view, MadeMesh> made_mesh_names[] = {
    {"icosphere", MadeMesh::icosphere}, {"grid", MadeMesh::grid}, {"tube", MadeMesh::tube}, {"fan", MadeMesh::fan}};

constexpr int max_levels = 9;  // 5.2 million faces
constexpr long long max_parts = 4096;
constexpr double largest = 0x1p100, smallest = 0x1p-100;  // so that no product of three overflows or vanishes

class MeshTable {
public:
    explicit MeshTable(toml::TableReader& table) : table_(table) {}

    Mesh make() {
        const MadeMesh kind = table_.one_of<MadeMesh>("make", made_mesh_names);
        const Vec<double> centre = read_point("centre");
        switch (kind) {
            case MadeMesh::icosphere:
                return make_icosphere(static_cast<int>(table_.integer("levels", 0, max_levels)), centre,
                                      read_size("radius", 1));
            case MadeMesh::grid: return make_grid_at(centre);
            case MadeMesh::tube: return make_tube_at(centre);
            case MadeMesh::fan: break;
        }
        return make_fan(read_multiple_of_four("count", 64), centre, read_size("radius", 1));
    }

private:
    Mesh make_grid_at(const Vec<double>& centre) {
        const auto parts = table_.optional_integers("parts", 2, 1, max_parts).value_or(std::vector{8LL, 8LL});
        double bump = 0;
        table_.read_number("bump", bump, 0, largest);
        if (bump != 0 && bump < smallest) table_.fail_at("bump", "must be 0, or at least 2^-100");
        return make_grid(static_cast<std::uint32_t>(parts[0]), static_cast<std::uint32_t>(parts[1]), centre,
                         {read_size("width", 2), read_size("height", 2), 0}, bump);
    }
    Mesh make_tube_at(const Vec<double>& centre) {
        const double ring = read_size("ring_radius", 2), radius = read_size("radius", 0.5);
        if (!(radius < ring)) table_.fail_at("radius", "must be less than ring_radius; the tube has a hole");
        return make_tube(read_multiple_of_four("around", 16), read_multiple_of_four("along", 64), centre, ring, radius);
    }

    Vec<double> read_point(std::string_view key) {
        Vec<double> p(0, 0, 0);
        if (const auto stored_point = table_.optional_vec3(key))
            for (int k = 0; k < 3; ++k) p[k] = toml::round_to_format((*stored_point)[k], binary64);
        for (int k = 0; k < 3; ++k)
            if (!(std::fabs(p[k]) <= largest)) table_.fail_at(key, "must lie within 2^100 of the origin");
        return p;
    }
    double read_size(std::string_view key, double default_value) {
        table_.read_number(key, default_value, smallest, largest);
        return default_value;
    }
    /// Reads a count that is a multiple of four, because a circle is divided by its quarters.
    std::uint32_t read_multiple_of_four(std::string_view key, long long default_value) {
        const long long n = table_.optional_integer(key, 4, max_parts * 256).value_or(default_value);
        if (n % 4 != 0) table_.fail_at(key, "must be a multiple of 4; write " + std::to_string(n / 4 * 4 + 4));
        return static_cast<std::uint32_t>(n);
    }

    toml::TableReader& table_;
};

Mesh read_named_file(toml::TableReader& table, const std::filesystem::path& folder, const MeshSettings& settings) {
    if (table.has("make")) table.reject("make", "is given together with file; a mesh is made or read, not both");
    const std::filesystem::path path = folder / table.string("file");
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        table.fail_at("file", "names " + path.string() +
                                  ", which is not a file; the path is relative to the folder "
                                  "of the scene");
    return read_mesh_file(path, settings);
}

Mesh make_from_table(toml::TableReader& table, const MeshSettings& settings) {
    table.node("make", R"("icosphere", "grid", "tube" or "fan", or write file = "name.obj" in its place)");
    Mesh mesh = MeshTable(table).make();
    merge_and_count(
        mesh, [](std::size_t face) { return "face " + std::to_string(face); }, settings.stop);
    if (mesh.faces.empty())
        table.fail_at("make",
                      "makes only triangles without area, because their vertices round to the same points so "
                      "far from the origin; move centre nearer to it, or make the mesh larger");
    return mesh;
}

Mesh read_table(toml::TableReader& table, const std::filesystem::path& folder, const MeshSettings& settings) {
    Mesh mesh = table.has("file") ? read_named_file(table, folder, settings) : make_from_table(table, settings);
    table.require_known_keys();
    return mesh;
}

}  // namespace

Mesh read_mesh_table(toml::TableReader& table, const std::filesystem::path& folder, const MeshSettings& settings) {
    try {
        return read_table(table, folder, settings);
    } catch (const std::bad_alloc&) {
        throw EnvironmentError(table.where(table.has("file") ? "file" : "make").text() +
                               ": this mesh does not fit into memory; use one with fewer triangles");
    }
}

}  // namespace lostbits::scene::triangle
