// Meshes that are made, how their edges are shared, and what a [[mesh]] may say.
#include <cmath>

#include "catch.hpp"
#include "scene/rays/rays.hpp"
#include "scene/rays/solid_list.hpp"
#include "scene/scene_text.hpp"
#include "shapes/triangle/mesh/made.hpp"

namespace test_mesh {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::test;
using scene::triangle::Mesh;

namespace {

Mesh tidied(Mesh mesh) {
    scene::triangle::tidy(mesh, [](std::size_t face) { return "face " + std::to_string(face); });
    return mesh;
}

/// Six times the volume that it encloses, positive where faces are counterclockwise from outside.
double six_volumes(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const Triangle<double> t = mesh.triangle(f);
        sum += dot(t.a, cross(t.b, t.c));
    }
    return sum;
}

std::string with_mesh(const std::string& table) {
    return replaced(good_scene, good_scene.substr(good_scene.find("[[sphere]]")), "") + "[[mesh]]\n" + table;
}

std::string error_of_mesh(const std::string& table) {
    const Scratch folder;
    const auto path = folder.write("scene.toml", with_mesh(table));
    return error_in(folder, [&] { scene::file::load_scene(path); });
}

}  // namespace

TEST_CASE("closed meshes are closed, wound outward, and of the genus of their shape", "[mesh]") {
    for (int levels = 0; levels < 5; ++levels) {
        const Mesh mesh = tidied(scene::triangle::make_icosphere(levels, {0, 0, 0}, 1));
        const auto topology = topology_of(mesh);
        CHECK(mesh.faces.size() == 20U << (2 * levels));
        CHECK(topology.is_closed());
        CHECK(topology.is_consistent());
        CHECK(mesh.vertices.size() + mesh.faces.size() - 3 * mesh.faces.size() / 2 == 2);
        CHECK(six_volumes(mesh) > 6 * 2.5);  // an icosahedron in the unit sphere has 2.536
        CHECK(six_volumes(mesh) < 6 * 4.189);
        for (std::size_t f = 0; f < mesh.faces.size(); ++f) CHECK_FALSE(mesh.has_border(f));
    }
    const Mesh tube = tidied(scene::triangle::make_tube(16, 64, {0, 0, 0}, 2, 0.5));
    const auto topology = topology_of(tube);
    CHECK(tube.faces.size() == 2048);
    CHECK(topology.is_closed());
    CHECK(topology.is_consistent());
    CHECK(tube.vertices.size() + tube.faces.size() == 3 * tube.faces.size() / 2);
    CHECK(six_volumes(tube) / 6 == Approx(2 * 9.8696 * 2 * 0.25).epsilon(0.05));  // 2π² R r²
}

TEST_CASE("open meshes have the border of their outline", "[mesh]") {
    const Mesh grid = tidied(scene::triangle::make_grid(5, 3, {1, 2, 3}, {2, 4, 0}, 0.5));
    CHECK(grid.faces.size() == 30);
    CHECK(topology_of(grid).border == 16);
    CHECK(topology_of(grid).is_consistent());
    const Mesh fan = tidied(scene::triangle::make_fan(12, {0, 0, 0}, 1));
    CHECK(topology_of(fan).border == 12);
    for (std::size_t f = 0; f < 12; ++f) CHECK(fan.has_border(f));
    for (const Vec<double>& v : fan.vertices) CHECK((length(v) == 0 || std::fabs(length(v) - 1) < 0x1p-50));
    double area = 0;
    for (std::size_t f = 0; f < 12; ++f) {
        const auto [a, b, c] = fan.triangle(f);
        CHECK(cross(b - a, c - a).z > 0);
        area += cross(b - a, c - a).z / 2;
    }
    CHECK(area == Approx(3).epsilon(0.01));  // of a regular twelve-gon
}

TEST_CASE("equal vertices become one, and faces without area are named", "[mesh]") {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, -0.0, 0}, {0, 1, -0.0}, {2, 0, 0}};
    mesh.faces = {{0, 1, 2}, {3, 5, 4}, {0, 1, 6}, {1, 4, 2}};
    mesh = tidied(std::move(mesh));
    CHECK(mesh.vertices.size() == 5);
    CHECK(mesh.faces.size() == 2);
    CHECK(mesh.left_out == 2);
    CHECK(mesh.first_left_out == "face 2");
    CHECK(topology_of(mesh).border == 4);
    CHECK(topology_of(mesh).is_consistent());
    CHECK(mesh.share_a_vertex(0, 1));
}

TEST_CASE("a format can flatten a face", "[mesh]") {
    const Mesh mesh = tidied(scene::triangle::make_grid(4, 4, {1, 1, 0}, {0x1p-20, 0x1p-20, 0}, 0));
    CHECK(flat_faces(mesh, binary64) == 0);
    CHECK(flat_faces(mesh, binary32) == 0);
    CHECK(flat_faces(mesh, binary16) == mesh.faces.size());
}

TEST_CASE("faces without area are told of, those of rounding where it rounds", "[mesh]") {
    const Scratch folder;
    folder.write("thin.obj",
                 "v 0 0 0\nv 1e6 0 0\nv 1000000.001 1 0\nv 1000000.005 2 0\nv 2e6 0 0\n"
                 "f 1 2 3\nf 1 2 5\nf 2 3 4\n");
    const auto remarks = [&](const std::string& inputs) {
        const std::string text = with_mesh("file = \"thin.obj\"\n");
        const auto path = folder.write("scene.toml", replaced(text, "shared", inputs));
        return scene::file::load_scene(path).front().remarks();
    };
    REQUIRE(remarks("own").size() == 1);
    CHECK(remarks("own")[0].starts_with("1 of 3 faces of its meshes have no area and are left out; the first is "));
    CHECK(remarks("own")[0].ends_with("thin.obj:7"));
    CHECK(remarks("shared").size() == 2);
}

TEST_CASE("meshes come after the other solids, and stored numbers are those of the scene's format", "[mesh]") {
    const Scratch folder;
    const std::string text = with_mesh("make = \"icosphere\"\nlevels = 1\n[[mesh]]\nmake = \"fan\"\ncount = 8\n");
    const auto scene = scene::file::load_scene(folder.write("scene.toml", text)).front();
    REQUIRE(scene.mesh);
    CHECK(scene.mesh->faces.size() == 88);
    CHECK(scene.solid_count() == 88);
    CHECK(scene.shapes() == std::vector{Shape::triangle});
    const auto all = scene.solids();
    const auto list = scene::rays::shared_solid_list(scene);
    REQUIRE(list.size() == all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Solid<double> stored = list[i], ideal = scene::rays::round_solid(all[i], binary32);
        CHECK(std::ranges::equal(stored.used(), ideal.used()));
        CHECK(std::ranges::equal(scene::rays::shared_solids(scene)[i].used(), ideal.used()));
    }
    CHECK_FALSE(scene.mesh->share_a_vertex(0, 80));
}

TEST_CASE("a mesh that cannot be made says why", "[mesh]") {
    CHECK(error_of_mesh("make = \"icosfere\"\n").find("did you mean \"icosphere\"") != std::string::npos);
    CHECK(error_of_mesh("make = \"icosphere\"\nlevels = 10\n").find("mesh[0].levels") != std::string::npos);
    CHECK(error_of_mesh("make = \"fan\"\ncount = 7\n").find("must be a multiple of 4; write 8") != std::string::npos);
    CHECK(error_of_mesh("make = \"tube\"\nradius = 3\n").find("must be less than ring_radius") != std::string::npos);
    CHECK(error_of_mesh("make = \"fan\"\nlevels = 3\n").find("mesh[0].levels") != std::string::npos);
    CHECK(error_of_mesh("centre = [0, 0, 0]\n").find("mesh[0].make is missing") != std::string::npos);
    CHECK(error_of_mesh("file = \"a.obj\"\n").find("mesh[0].file names ") != std::string::npos);
    CHECK(error_of_mesh("make = \"fan\"\nfile = \"a.obj\"\n").find("mesh[0].make stands beside file") !=
          std::string::npos);
}

}  // namespace test_mesh
