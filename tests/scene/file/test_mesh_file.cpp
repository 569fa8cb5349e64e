// Files of meshes: vertices arrive with the bits of the file, and what is no mesh is told by its place.
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "catch.hpp"
#include "counts.hpp"
#include "number/random.hpp"
#include "scene/scene_text.hpp"
#include "shapes/triangle/mesh/made.hpp"
#include "shapes/triangle/mesh/mesh_file.hpp"

namespace test_mesh_file {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::test;
using scene::triangle::Mesh;
using scene::triangle::read_mesh_file;

namespace {

template <class T>
void append(std::string& to, T x, bool turned = false) {
    char raw[sizeof x];
    std::memcpy(raw, &x, sizeof x);
    if (turned) std::reverse(std::begin(raw), std::end(raw));
    to.append(raw, sizeof x);
}

std::string as_obj(const Mesh& mesh) {
    std::string text = "# an object\no ball\n";
    for (const auto& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
    for (const auto& [a, b, c] : mesh.faces)
        text += fmt::format("f {}/1/1 {}//2 {}\n", a + 1, b + 1,
                            static_cast<long>(c) - static_cast<long>(mesh.vertices.size()));
    return text;
}

std::string ply_header(const char* format, const char* type, const Mesh& mesh) {
    return fmt::format(
        "ply\nformat {} 1.0\ncomment made by a test\nelement vertex {}\nproperty uchar red\nproperty {} x\nproperty {} "
        "y\n"
        "property {} z\nelement face {}\nproperty list uchar uint vertex_indices\nelement edge 1\nproperty int "
        "vertex1\n"
        "end_header\n",
        format, mesh.vertices.size(), type, type, type, mesh.faces.size());
}

template <class T>
std::string as_ply_text(const Mesh& mesh) {
    std::string text = ply_header("ascii", sizeof(T) == 4 ? "float" : "double", mesh);
    for (const auto& v : mesh.vertices)
        text += fmt::format("255 {} {} {}\n", static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z));
    for (const auto& [a, b, c] : mesh.faces) text += fmt::format("3 {} {} {}\n", a, b, c);
    return text + "7\n";
}

template <class T>
std::string as_ply_bytes(const Mesh& mesh, bool big) {
    std::string all =
        ply_header(big ? "binary_big_endian" : "binary_little_endian", sizeof(T) == 4 ? "float32" : "float64", mesh);
    for (const auto& v : mesh.vertices) {
        all += '\x7f';
        for (int k = 0; k < 3; ++k) append(all, static_cast<T>(v[k]), big);
    }
    for (const auto& face : mesh.faces) {
        all += '\3';
        for (const std::uint32_t corner : face) append(all, corner, big);
    }
    append(all, std::int32_t{7}, big);
    return all;
}

std::string as_stl_bytes(const Mesh& mesh) {
    std::string all = "solid, says the head of this binary file";
    all.resize(80, ' ');
    append(all, static_cast<std::uint32_t>(mesh.faces.size()));
    for (const auto& face : mesh.faces) {
        for (int k = 0; k < 3; ++k) append(all, 0.0f);
        for (const std::uint32_t corner : face)
            for (int k = 0; k < 3; ++k) append(all, static_cast<float>(mesh.vertices[corner][k]));
        all += std::string(2, '\0');
    }
    return all;
}

std::string as_stl_text(const Mesh& mesh) {
    std::string text = "solid ball\n";
    for (const auto& face : mesh.faces) {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for (const std::uint32_t corner : face) {
            const auto& v = mesh.vertices[corner];
            text += fmt::format("      vertex {} {} {}\n", v.x, v.y, v.z);
        }
        text += "    endloop\n  endfacet\n";
    }
    return text + "endsolid ball\n";
}

/// The JSON of a mesh whose buffer begins with the places (uint32), then has the vertices; `buffer` says where it is.
std::string as_gltf(const Mesh& mesh, const std::string& buffer, const std::string& node = "") {
    const std::size_t places = 12 * mesh.faces.size(), vertices = 12 * mesh.vertices.size();
    return fmt::format(
        R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0{}}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 1}}, "indices": 0}}]}}],
            "accessors": [{{"bufferView": 0, "componentType": 5125, "count": {}, "type": "SCALAR"}},
                          {{"bufferView": 1, "componentType": 5126, "count": {}, "type": "VEC3"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": {}}}, {{"buffer": 0, "byteOffset": {}, "byteLength": {}}}],
            "buffers": [{{"byteLength": {}{}}}]}})",
        node, 3 * mesh.faces.size(), mesh.vertices.size(), places, places, vertices, places + vertices, buffer);
}
std::string buffer_of_gltf(const Mesh& mesh) {
    std::string bytes;
    for (const auto& face : mesh.faces)
        for (const std::uint32_t corner : face) append(bytes, corner);
    for (const auto& v : mesh.vertices)
        for (int k = 0; k < 3; ++k) append(bytes, static_cast<float>(v[k]));
    return bytes;
}
std::string as_glb(const Mesh& mesh) {
    std::string json = as_gltf(mesh, ""), buffer = buffer_of_gltf(mesh), all = "glTF";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    append(all, std::uint32_t{2});
    append(all, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
    append(all, static_cast<std::uint32_t>(json.size()));
    all += "JSON" + json;
    append(all, static_cast<std::uint32_t>(buffer.size()));
    return all + std::string("BIN\0", 4) + buffer;
}

/// A fan of triangles whose corners are random numbers of any exponent that a cross product of floats survives.
Mesh random_mesh(bool of_binary32) {
    lostbits::test::Random random(11);
    Mesh mesh;
    for (std::uint32_t i = 0; i < 33000; ++i) {
        Vec<double> v;
        for (int k = 0; k < 3; ++k) {
            v[k] = random.sign() * std::ldexp(1 + random.unit(), static_cast<int>(random.between(-30, 30)));
            if (of_binary32) v[k] = static_cast<float>(v[k]);
        }
        mesh.vertices.push_back(v);
        if (i >= 2) mesh.faces.push_back({i - 2, i - 1, i});
    }
    return mesh;
}

bool are_same(const Mesh& a, const Mesh& b) {
    if (a.faces.size() != b.faces.size()) return false;
    for (std::size_t f = 0; f < a.faces.size(); ++f) {
        const auto x = a.triangle(f), y = b.triangle(f);
        if (x.a != y.a || x.b != y.b || x.c != y.c) return false;
    }
    return true;
}

std::string error_of_file(const std::string& name, const std::string& bytes) {
    const Scratch folder;
    const auto path = folder.write(name, bytes);
    return error_in(folder, [&] { read_mesh_file(path); });
}

}  // namespace

TEST_CASE("vertices arrive with the bits of the file", "[mesh]") {
    const Scratch folder;
    const auto arrives = [&](const char* name, const Mesh& mesh, const std::string& bytes) {
        INFO(name);
        CHECK(are_same(read_mesh_file(folder.write(name, bytes)), mesh));
    };
    const Mesh wide = random_mesh(false), narrow = random_mesh(true);
    arrives("wide.obj", wide, as_obj(wide));
    arrives("wide.ply", wide, as_ply_text<double>(wide));
    arrives("wide-little.ply", wide, as_ply_bytes<double>(wide, false));
    arrives("wide-big.ply", wide, as_ply_bytes<double>(wide, true));
    arrives("wide.stl", wide, as_stl_text(wide));
    arrives("narrow.obj", narrow, as_obj(narrow));
    arrives("narrow.ply", narrow, as_ply_text<float>(narrow));
    arrives("narrow-little.ply", narrow, as_ply_bytes<float>(narrow, false));
    arrives("narrow-big.ply", narrow, as_ply_bytes<float>(narrow, true));
    arrives("narrow.stl", narrow, as_stl_bytes(narrow));
    arrives("narrow.glb", narrow, as_glb(narrow));
    folder.write("narrow.bin", buffer_of_gltf(narrow));
    arrives("narrow.gltf", narrow, as_gltf(narrow, R"(, "uri": "narrow.bin")"));
}

TEST_CASE("a file without indices is as closed as the mesh that was written", "[mesh]") {
    Mesh ball = scene::triangle::make_icosphere(2, {0, 0, 0}, 1);
    for (auto& v : ball.vertices)
        for (int k = 0; k < 3; ++k) v[k] = static_cast<float>(v[k]);
    const Scratch folder;
    for (const auto& path : {folder.write("a.stl", as_stl_bytes(ball)), folder.write("b.stl", as_stl_text(ball)),
                             folder.write("c.obj", as_obj(ball))}) {
        const Mesh read = read_mesh_file(path);
        CHECK(read.vertices.size() == ball.vertices.size());
        CHECK(2 * shared_edges(read).size() == 3 * ball.faces.size());
        CHECK(are_same(read, ball));
    }
}

TEST_CASE("a polygon is a fan around its first corner, and a face on a line is named", "[mesh]") {
    const Scratch folder;
    const Mesh mesh =
        read_mesh_file(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 2 5\nf 1 2 3 4\n"));
    REQUIRE(mesh.faces.size() == 2);
    CHECK(mesh.triangle(1).c == Vec<double>(0, 1, 0));
    CHECK(mesh.left_out == 1);
    CHECK(mesh.first_left_out.ends_with("a.obj:6"));
}

TEST_CASE("what is no mesh is told by its place", "[mesh]") {
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    CHECK(error_of_file("a.obj", three + "f 1 2 4\n") ==
          "a.obj:4: names vertex 4, and 3 stand above; vertices count from 1, and a face follows its vertices");
    CHECK(error_of_file("a.obj", three + "f 0 1 2\n") ==
          "a.obj:4: names vertex 0; vertices count from 1, and -1 is the last one");
    CHECK(error_of_file("a.obj", three + "f 1 2\n") == "a.obj:4: is a face of fewer than 3 corners");
    CHECK(error_of_file("a.obj", three + "f 1 2 x\n") == "a.obj:4: the corner \"x\" is not the number of a vertex");
    CHECK(error_of_file("a.obj", "v 0 nan 0\n") == "a.obj:1: y is \"nan\"; a vertex has finite numbers");
    CHECK(error_of_file("a.obj", "v 0 1e999 0\n") == "a.obj:1: y is \"1e999\", which overflows");
    CHECK(error_of_file("a.obj", "v 0 0\n") == "a.obj:1: ends before z");
    CHECK(error_of_file("a.obj", three) == "a.obj: has no faces; a mesh has at least one triangle");
    CHECK(error_of_file("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").starts_with("a.obj: all of its faces lie on"));
    CHECK(error_of_file("a.obj", std::string(2 << 20, 'x')) ==
          "a.obj:1: is longer than 1 MB; a mesh has a vertex or a face a line");
    CHECK(error_of_file("a.fbx", "") ==
          "a.fbx: the kind of a mesh is told by the end of its name; it ends in .obj, .ply, .stl, .gltf or .glb");
    CHECK(error_of_file("a.ply", "plx\n") == "a.ply:1: is not a PLY: its first line is not ply");

    const Mesh ball = scene::triangle::make_icosphere(0, {0, 0, 0}, 1);
    const std::string stl = as_stl_bytes(ball), ply = as_ply_bytes<float>(ball, false);
    CHECK(has(error_of_file("a.stl", "x" + stl.substr(1, 500)), "was it cut short?"));
    CHECK(has(error_of_file("a.ply", ply.substr(0, 500)), "ends before all elements are there"));
    const std::string other_order = replaced(ply, "little", "big");
    CHECK(has(error_of_file("a.ply", other_order), "is the order of bytes the one that format says?"));
}

TEST_CASE("a glTF that moves its mesh, or whose buffer is elsewhere, is refused", "[mesh]") {
    const Scratch folder;
    const Mesh ball = scene::triangle::make_icosphere(0, {0, 0, 0}, 1);
    const std::string buffer = R"(, "uri": "a.bin")", bytes = buffer_of_gltf(ball);
    const auto error_with = [&](const std::string& json, const std::string& bin) {
        folder.write("a.bin", bin);
        const auto path = folder.write("a.gltf", json);
        return error_in(folder, [&] { read_mesh_file(path); });
    };
    CHECK(error_with(as_gltf(ball, buffer), bytes) == "no error");
    CHECK(error_with(as_gltf(ball, buffer, R"(, "translation": [0, 0, 0])"), bytes) == "no error");
    CHECK(error_with(as_gltf(ball, buffer, R"(, "name": "ball", "translation": [0, 0, 1e-9])"), bytes) ==
          "a.gltf: node 0 (ball) is moved by a transform, which would round its vertices; apply transforms before you "
          "export");
    CHECK(error_with(as_gltf(ball, buffer, R"(, "children": [0])"), bytes) == "a.gltf: node 0 stands in itself");
    CHECK(error_with(as_gltf(ball, buffer), bytes.substr(0, 100)).starts_with("a.gltf: is not read: "));
    std::string wrong = bytes;
    wrong[3] = '\x7f';
    CHECK(error_with(as_gltf(ball, buffer), wrong).starts_with("a.gltf: face 0 names vertex "));
    CHECK(error_with(replaced(as_gltf(ball, buffer), "5126", "5120"), bytes) ==
          "a.gltf: has vertices that are not three floats");
    CHECK(has(error_with(replaced(as_gltf(ball, buffer), "\"byteOffset\": 240", "\"byteOffset\": 300"), bytes),
              "was it cut short?"));
    CHECK(error_with("{", bytes).starts_with("a.gltf: is not read: "));
}

TEST_CASE("files that are cut or have other bits are read or refused", "[mesh]") {
    const Mesh ball = scene::triangle::make_icosphere(1, {0, 0, 0}, 1);
    const Scratch folder;
    lostbits::test::Random random(5);
    std::size_t refused = 0;
    const std::pair<const char*, std::string> files[] = {
        {"a.obj", as_obj(ball)},       {"b.ply", as_ply_text<double>(ball)}, {"c.ply", as_ply_bytes<float>(ball, true)},
        {"d.stl", as_stl_bytes(ball)}, {"e.stl", as_stl_text(ball)},         {"f.glb", as_glb(ball)}};
    for (const auto& [name, whole] : files) {
        for (int i = 0; i < lostbits::test::draws(300); ++i) {
            std::string bytes = whole;
            const auto place = static_cast<std::size_t>(random.between(0, static_cast<long>(bytes.size()) - 1));
            if (i % 3 == 0) bytes.resize(place);
            else bytes[place] = static_cast<char>(bytes[place] ^ (1 << random.between(0, 7)));
            const std::string error = error_of([&] { read_mesh_file(folder.write(name, bytes)); });
            INFO(name << ", change " << i << ": " << error);
            CHECK(error.find("another error") == std::string::npos);
            refused += error != "no error";
        }
    }
    CHECK(refused > static_cast<std::size_t>(lostbits::test::draws(300)));
}

}  // namespace test_mesh_file
