// Generated meshes and flakes, the sharing of edges, and the tables of a scene about meshes and about a march.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "catch.hpp"
#include "number/real.hpp"
#include "scene/rays/primitive_list.hpp"
#include "scene/rays/rays.hpp"
#include "scene/scene_text.hpp"
#include "shapes/sphere/flake/sphereflake.hpp"
#include "shapes/triangle/mesh/made.hpp"

namespace test_mesh {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::test;
using namespace lostbits::scene::file;
using namespace lostbits::scene::rays;
using namespace lostbits::scene::sphere;
using scene::triangle::Mesh;

namespace {

Mesh tidy(Mesh mesh) {
    scene::triangle::merge_and_count(mesh, [](std::size_t face) { return "face " + std::to_string(face); });
    return mesh;
}

/// Sides of faces that no one other face has; 0 of a closed mesh. And whether where two faces meet one runs up and one
/// down: none of them is turned.
struct Edges {
    std::size_t open;
    bool are_consistent = true;

    explicit Edges(const Mesh& mesh) {
        const auto shared = find_shared_edges(mesh);
        open = 3 * mesh.faces.size() - 2 * shared.size();
        for (const auto& [ends, faces] : shared) {
            const auto runs_up = [&](const scene::triangle::Face& face) {
                const auto from = static_cast<std::size_t>(std::ranges::find(face, ends[0]) - face.begin());
                return face[(from + 1) % 3] == ends[1];
            };
            are_consistent = are_consistent && runs_up(mesh.faces[faces[0]]) != runs_up(mesh.faces[faces[1]]);
        }
    }
};

/// Six times the enclosed volume, positive if faces are counterclockwise from outside.
double six_volumes(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const Triangle<double> t = mesh.triangle(f);
        sum += dot(t.a, cross(t.b, t.c));
    }
    return sum;
}

std::string with_mesh(const std::string& table) {
    return replace_text(good_scene, good_scene.substr(good_scene.find("[[sphere]]")), "") + "[[mesh]]\n" + table;
}

std::string error_of_mesh(const std::string& table) {
    const Scratch folder;
    const auto path = folder.write("scene.toml", with_mesh(table));
    return error_in(folder, [&] { load_scene(path); });
}

std::vector<Sphere<double>> spheres_of(const Sphereflake& flake) {
    std::vector<Sphere<double>> all;
    for_each_primitive(flake, [&all](const Primitive<double>& primitive) { all.push_back(primitive.sphere()); });
    return all;
}

double apart(const Vec<double>& a, const Vec<double>& b) { return length(a - b); }

}  // namespace

TEST_CASE("closed meshes are closed, wound outward and of the right genus", "[mesh]") {
    for (int levels = 0; levels < 5; ++levels) {
        const Mesh mesh = tidy(scene::triangle::make_icosphere(levels, {0, 0, 0}, 1));
        const Edges edges(mesh);
        CHECK(mesh.faces.size() == 20U << (2 * levels));
        CHECK(edges.open == 0);
        CHECK(edges.are_consistent);
        CHECK(mesh.vertices.size() + mesh.faces.size() - 3 * mesh.faces.size() / 2 == 2);
        CHECK(six_volumes(mesh) > 6 * 2.5);  // an icosahedron in the unit sphere has 2.536
        CHECK(six_volumes(mesh) < 6 * 4.189);
        for (std::size_t f = 0; f < mesh.faces.size(); ++f) CHECK_FALSE(mesh.has_border(f));
    }
    const Mesh tube = tidy(scene::triangle::make_tube(16, 64, {0, 0, 0}, 2, 0.5));
    const Edges edges(tube);
    CHECK(tube.faces.size() == 2048);
    CHECK(edges.open == 0);
    CHECK(edges.are_consistent);
    CHECK(tube.vertices.size() + tube.faces.size() == 3 * tube.faces.size() / 2);
    CHECK(six_volumes(tube) / 6 == Approx(2 * 9.8696 * 2 * 0.25).epsilon(0.05));  // 2π² R r²
}

TEST_CASE("edges and borders agree with a comparison of all pairs of faces", "[mesh]") {
    std::mt19937 random(5);
    std::size_t borders = 0, duplicates = 0, many = 0;
    for (int k = 0; k < 60; ++k) {
        Mesh mesh;
        const auto count = 4 + random() % 9;
        for (std::size_t v = 0; v < count; ++v)
            mesh.vertices.emplace_back(random() % 64, random() % 64, static_cast<double>(v * v));
        while (mesh.faces.size() < 3 * count) {
            const auto corner = [&] { return static_cast<std::uint32_t>(random() % count); };
            const scene::triangle::Face face{corner(), corner(), corner()};
            if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) mesh.faces.push_back(face);
        }
        mesh = tidy(std::move(mesh));
        const auto sorted = [&](std::size_t f) {
            auto face = mesh.faces[f];
            std::ranges::sort(face);
            return face;
        };
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<std::size_t, 2>> ways;  // up, down
        std::set<scene::triangle::Face> different;
        for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
            different.insert(sorted(f));
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint32_t from = mesh.faces[f][i], to = mesh.faces[f][(i + 1) % 3];
                ++ways[std::minmax(from, to)][from < to ? 0 : 1];
            }
        }
        scene::triangle::MeshCounts expected{.edges = ways.size(),
                                             .duplicate_faces = mesh.faces.size() - different.size()};
        for (const auto& [edge, of] : ways) {
            const std::size_t all = of[0] + of[1];
            expected.border_edges += all == 1, expected.non_manifold_edges += all > 2;
            expected.unbalanced_edges += of[0] != of[1], expected.odd_edges += all % 2;
        }
        const auto all_of = [](const scene::triangle::MeshCounts& of) {
            return std::array{of.edges,     of.border_edges,   of.non_manifold_edges, of.unbalanced_edges,
                              of.odd_edges, of.duplicate_faces};
        };
        CHECK(all_of(mesh.counts) == all_of(expected));
        for (std::size_t f = 0; f < mesh.faces.size(); ++f)
            for (std::size_t i = 0; i < 3; ++i) {
                const auto& of = ways.at(std::minmax(mesh.faces[f][(i + 1) % 3], mesh.faces[f][(i + 2) % 3]));
                CHECK(mesh.is_border(f, i) == (of[0] + of[1] == 1));
                borders += mesh.is_border(f, i);
            }
        duplicates += expected.duplicate_faces, many += expected.non_manifold_edges;
        const Mesh twice = scene::triangle::join_meshes({mesh, mesh});
        CHECK(twice.counts.border_edges == 2 * expected.border_edges);
        CHECK(twice.counts.duplicate_faces == 2 * expected.duplicate_faces);
        CHECK(twice.borders.size() == twice.faces.size());
    }
    CHECK(borders > 100);
    CHECK(duplicates > 20);
    CHECK(many > 100);
}

TEST_CASE("open meshes have the border of their outline", "[mesh]") {
    const Mesh grid = tidy(scene::triangle::make_grid(5, 3, {1, 2, 3}, {2, 4, 0}, 0.5));
    CHECK(grid.faces.size() == 30);
    CHECK(Edges(grid).open == 16);
    CHECK(Edges(grid).are_consistent);
    const Mesh fan = tidy(scene::triangle::make_fan(12, {0, 0, 0}, 1));
    CHECK(Edges(fan).open == 12);
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

TEST_CASE("equal vertices are merged, and faces without area are named", "[mesh]") {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, -0.0, 0}, {0, 1, -0.0}, {2, 0, 0}};
    mesh.faces = {{0, 1, 2}, {3, 5, 4}, {0, 1, 6}, {1, 4, 2}};
    mesh = tidy(std::move(mesh));
    CHECK(mesh.vertices.size() == 5);
    CHECK(mesh.faces.size() == 2);
    CHECK(mesh.removed_face_count == 2);
    CHECK(mesh.first_removed_face == "face 2");
    CHECK(Edges(mesh).open == 4);
    CHECK(Edges(mesh).are_consistent);
    CHECK(mesh.share_a_vertex(0, 1));
}

TEST_CASE("rounding to a format can flatten a face", "[mesh]") {
    const Mesh mesh = tidy(scene::triangle::make_grid(4, 4, {1, 1, 0}, {0x1p-20, 0x1p-20, 0}, 0));
    CHECK(count_flat_faces(mesh, binary64) == 0);
    CHECK(count_flat_faces(mesh, binary32) == 0);
    CHECK(count_flat_faces(mesh, binary16) == mesh.faces.size());
}

TEST_CASE("faces without area are reported, those caused by rounding only where the format rounds", "[mesh]") {
    const Scratch folder;
    folder.write("thin.obj",
                 "v 0 0 0\nv 1e6 0 0\nv 1000000.001 1 0\nv 1000000.005 2 0\nv 2e6 0 0\n"
                 "f 1 2 3\nf 1 2 5\nf 2 3 4\n");
    const auto remarks = [&](const std::string& inputs) {
        const std::string text = with_mesh("file = \"thin.obj\"\n");
        const auto path = folder.write("scene.toml", replace_text(text, "shared", inputs));
        return load_scene(path).front().remarks();
    };
    REQUIRE(remarks("own").size() == 1);
    CHECK(remarks("own")[0].starts_with("1 of 3 faces of its meshes have no area and are left out; the first is "));
    CHECK(remarks("own")[0].ends_with("thin.obj:7"));
    CHECK(remarks("shared").size() == 2);
}

TEST_CASE("meshes come after the other primitives, and their numbers are stored in the scene's format", "[mesh]") {
    const std::string text = with_mesh("make = \"icosphere\"\nlevels = 1\n[[mesh]]\nmake = \"fan\"\ncount = 8\n");
    const auto scene = load_text(text);
    REQUIRE(scene.mesh);
    CHECK(scene.mesh->faces.size() == 88);
    CHECK(scene.primitive_count() == 88);
    CHECK(scene.shapes() == std::vector{Shape::triangle});
    const auto all = scene.primitives();
    const auto list = make_shared_primitive_list(scene);
    REQUIRE(list.size() == all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Primitive<double> stored = list[i], ideal = round_primitive(all[i], binary32);
        CHECK(std::ranges::equal(stored.shape_numbers(), ideal.shape_numbers()));
        CHECK(std::ranges::equal(make_shared_primitives(scene)[i].shape_numbers(), ideal.shape_numbers()));
    }
    CHECK_FALSE(scene.mesh->share_a_vertex(0, 80));
}

TEST_CASE("a mesh that cannot be made is refused with the reason", "[mesh]") {
    CHECK(has(error_of_mesh("make = \"icosphere\"\nlevels = 10\n"), "mesh[0].levels"));
    CHECK(has(error_of_mesh("make = \"fan\"\ncount = 7\n"), "must be a multiple of 4; write 8"));
    CHECK(has(error_of_mesh("make = \"tube\"\nradius = 3\n"), "must be less than ring_radius"));
    CHECK(has(error_of_mesh("make = \"fan\"\nlevels = 3\n"), "mesh[0].levels"));
    CHECK(has(error_of_mesh("centre = [0, 0, 0]\n"),
              "mesh[0].make is missing; give it \"icosphere\", \"grid\", "
              "\"tube\" or \"fan\", or write file = \"name.obj\" in its "
              "place"));
    CHECK(has(error_of_mesh("file = \"a.obj\"\n"), "mesh[0].file names "));
    CHECK(has(error_of_mesh("make = \"fan\"\nfile = \"a.obj\"\n"), "mesh[0].make is given together with file"));
}

TEST_CASE("each level of a sphereflake has nine times as many spheres as the level before") {
    CHECK(Sphereflake{.levels = 0}.size() == 1);
    CHECK(Sphereflake{.levels = 2}.size() == 91);
    CHECK(Sphereflake{.levels = 5}.size() == 66430);
    CHECK(Sphereflake{.levels = 8}.size() == 48427561);
    CHECK(spheres_of({.levels = 4}).size() == Sphereflake{.levels = 4}.size());
}

TEST_CASE("children of a sphereflake touch their parent: six around its equator, three above it") {
    const auto all = spheres_of({.levels = 1, .centre = {1, 2, 3}, .radius = 0.75, .axis = {0.2, 0.9, 0.4}});
    REQUIRE(all.size() == 10);
    const Vec<double> w = Vec<double>(0.2, 0.9, 0.4) / std::sqrt(0.04 + 0.81 + 0.16);
    for (std::size_t i = 1; i < 10; ++i) {
        CHECK(all[i].radius == 0.25);
        CHECK(apart(all[i].centre, all[0].centre) == Approx(1.0).epsilon(1e-14));
        CHECK(dot(all[i].centre - all[0].centre, w) == Approx(i < 7 ? 0.0 : std::sqrt(2.0 / 3.0)).margin(1e-14));
        for (std::size_t k = 1; k < i; ++k) CHECK(apart(all[i].centre, all[k].centre) > 0.5);  // they do not meet
    }
    CHECK(apart(all[1].centre, all[2].centre) == Approx(1.0).epsilon(1e-14));  // 60 degrees
    CHECK(apart(all[7].centre, all[8].centre) == Approx(1.0).epsilon(1e-14));  // 120 degrees on the smaller circle
}

TEST_CASE("the sphereflake of two levels equals the scene that lists its ninety-one spheres") {
    const Scene written = load_scene(fs::path(LOSTBITS_DATA_DIR) / "scenes/rtg-fig-7-6-near.toml").front();
    const auto all = spheres_of({.levels = 2, .axis = {0.2, 0.9, 0.4}});
    REQUIRE(written.listed.size() == all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        CHECK(std::fabs(static_cast<double>(written.listed[i].sphere().radius) - all[i].radius) < 1e-9);
        for (int k = 0; k < 3; ++k)
            CHECK(std::fabs(static_cast<double>(written.listed[i].sphere().centre[k]) - all[i].centre[k]) < 2e-9);
    }
}

TEST_CASE("a sphereflake comes after the other spheres, and a wrong one is refused with its line") {
    const std::string text =
        replace_text(good_scene, "[[sphere]]", "[sphereflake]\nlevels = 1\nradius = 0.5\n[[sphere]]");
    const Scene s = load_text(text);
    CHECK(s.shapes() == std::vector{Shape::sphere});
    CHECK(s.primitives().size() == 11);
    const auto shared = make_shared_primitives(s);
    REQUIRE(shared.size() == 11);
    CHECK(shared[0].sphere().radius == 1);
    CHECK(shared[1].sphere().radius == 0.5);
    CHECK(shared[10].sphere().radius == static_cast<double>(static_cast<float>(0.5 / 3)));
    const auto broken = [&](const std::string& from, const std::string& to) {
        return scene_error(replace_text(text, from, to));
    };
    CHECK(broken("levels = 1", "levels = 10")
              .find("scene.toml:14:10: sphereflake.levels must be a whole number from 0 to 9") == 0);
    CHECK(has(broken("levels = 1", "levels = 1.5"), "sphereflake.levels must be a whole number"));
    CHECK(broken("radius = 0.5", "radius = 0").find("scene.toml:15:10: sphereflake.radius must lie between") == 0);
    CHECK(has(broken("radius = 0.5", "axis = [0, 0, 0]"), "sphereflake.axis is not a direction"));
}

TEST_CASE("constants of a march default to the seed's values, and wrong ones are refused with their line") {
    const std::string text = replace_text(good_scene, "[[sphere]]", "[march]\nhit_eps = 0.01\n[[sphere]]");
    const Scene s = load_text(text);
    REQUIRE(s.march);
    CHECK(s.march->hit_eps == Real("0.01"));
    CHECK(s.march->max_dist == 20);
    CHECK(s.march->max_steps == 64);
    CHECK(s.accepts(Shape::sdf));
    CHECK(s.accepts(Shape::sphere));
    const auto broken = [&](const std::string& to) { return scene_error(replace_text(text, "hit_eps = 0.01", to)); };
    CHECK(broken("hit_eps = 0").find("scene.toml:14:11: march.hit_eps must be greater than 0") == 0);
    CHECK(has(broken("hit_eps = 1e-50"), "march.hit_eps must be greater than 0 when it is stored"));
    CHECK(has(broken("max_dist = 1e39"), "march.max_dist overflows binary32"));
    CHECK(has(broken("max_steps = 0"), "march.max_steps must be a whole number from 1 to 100000"));
    CHECK(has(broken("max_steps = 2.5"), "march.max_steps must be a whole number"));
    CHECK(has(broken("over_relaxation = 2"), "march.over_relaxation must lie in [1, 2)"));
}

}  // namespace test_mesh
