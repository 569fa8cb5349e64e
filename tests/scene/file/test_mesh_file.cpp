// Files of meshes: vertices arrive with the bits of the file, and what is no mesh is told by its place.
#include <sys/stat.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <tuple>

#include <fmt/format.h>

#include "catch.hpp"
#include "counts.hpp"
#include "number/random.hpp"
#include "scene/scene_text.hpp"
#include "shapes/triangle/mesh/made.hpp"
#include "shapes/triangle/mesh/mesh_file.hpp"
#include "shapes/triangle/mesh/mesh_readers.hpp"

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
          "a.obj:4:7: names vertex 4, and 3 stand above; vertices count from 1, and a face follows its vertices");
    CHECK(error_of_file("a.obj", three + "f 0 1 2\n") ==
          "a.obj:4:3: names vertex 0; vertices count from 1, and -1 is the last one");
    CHECK(error_of_file("a.obj", three + " f 1 2\n") == "a.obj:4:2: is a face of fewer than 3 corners");
    CHECK(error_of_file("a.obj", three + "f 1 2 x\n") == "a.obj:4:7: the corner \"x\" is not the number of a vertex");
    CHECK(error_of_file("a.obj", "v 0 nan 0\n") ==
          "a.obj:1:5: y is \"nan\", which is not finite; a vertex has finite numbers");
    CHECK(error_of_file("a.obj", "v 0 1e999 0\n") == "a.obj:1:5: y is \"1e999\", which overflows");
    CHECK(error_of_file("a.obj", "v 0 +-1 0\n") == "a.obj:1:5: y is \"+-1\", which is not a number");
    CHECK(error_of_file("a.obj", "v 0 0\n") == "a.obj:1:6: ends before z");
    CHECK(error_of_file("a.obj", "# \u00e9\nv \u00e9 0 0\n") == "a.obj:2:3: x is \"\u00e9\", which is not a number");
    CHECK(error_of_file("a.obj", three) == "a.obj: has no faces; a mesh has at least one triangle");
    CHECK(error_of_file("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").starts_with("a.obj: all of its faces lie on"));
    CHECK(error_of_file("a.obj", std::string(2 << 20, 'x')) ==
          "a.obj:1:1: is longer than 1 MB; a mesh has a vertex or a face a line");
    CHECK(error_of_file("a.fbx", "") ==
          "a.fbx: the kind of a mesh is told by the end of its name; it ends in .obj, .ply, .stl, .gltf or .glb");

    const Mesh ball = scene::triangle::make_icosphere(0, {0, 0, 0}, 1);
    const std::string stl = as_stl_bytes(ball), ply = as_ply_bytes<float>(ball, false);
    CHECK(error_of_file("a.stl", "x" + stl.substr(1, 500)) ==
          "a.stl: byte 80: is not an STL: it does not begin with the word solid, and with 20 facets it would have 1084 "
          "bytes and not 501; was it cut short?");
    CHECK(error_of_file("a.ply", ply.substr(0, 500)) ==
          "a.ply: byte 500: ends before all elements are there; was it cut short?");
    CHECK(error_of_file("a.ply", ply.substr(0, 300)) ==
          "a.ply: byte 256: ends before the 12 elements of vertex, which take at least 156 bytes; was it cut short?");
    const std::string other_order = replaced(ply, "little", "big");
    CHECK(has(error_of_file("a.ply", other_order), "is the order of bytes the one that format says?"));
}

TEST_CASE("what would hide a line or a face of a text is refused", "[mesh]") {
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", face = three + "f 1 2 3\n";
    CHECK(error_of_file("a.obj", face + std::string("\0f 1 3 2\n", 10)) == "a.obj:5:1: has a byte 0; is it text?");
    CHECK(error_of_file("a.obj", face + std::string("f 1 3\0 2\n", 9)) == "a.obj:5:6: has a byte 0; is it text?");
    CHECK(error_of_file("a.obj", face + "# a\rf 1 3 2\n") ==
          "a.obj:5:4: has a carriage return inside of the line; write line feeds");
    CHECK(error_of_file("a.obj", face + "\xEF\xBB\xBF"
                                        "f 1 3 2\n")
              .starts_with("a.obj:5:1: "));
    CHECK(has(error_of_file("a.obj", face + "F 1 3 2\n"), "a.obj:5:1: \"F\" begins no line of an OBJ"));
    CHECK(error_of_file("a.obj", "\xEF\xBB\xBF# a mesh\r\n" + face + "usemtl red\nvn 0 0 1\n\n#comment\n") ==
          "no error");

    const auto stl = [](const std::string& facets) { return error_of_file("a.stl", "solid a\n" + facets); };
    const std::string corners = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n",
                      facet = corners + "endloop\nendfacet\n";
    CHECK(stl(facet + "endsolid a\n") == "no error");
    CHECK(stl(facet) == "a.stl:8:1: ends before endsolid; was it cut short?");
    CHECK(stl(facet + corners) == "a.stl:13:1: ends inside of a facet; was it cut short?");
    CHECK(stl(facet + "facet normal 0 0 1\nouter loop\nvertex 0 0 0\n") ==
          "a.stl:11:1: ends inside of a facet; was it cut short?");
    CHECK(stl(corners + "facet normal 0 0 1\n") == "a.stl:7:1: stands inside of a facet, which endfacet ends");
    CHECK(stl(facet + "vertex 0 0 0\n") == "a.stl:9:1: stands in a solid, outside of its facets");
    CHECK(stl(facet + "verte 0 0 0\n") == "a.stl:9:1: \"verte\" begins no line of an STL; is it one?");

    const auto ply = [](const std::string& header, const std::string& body) {
        return error_of_file("a.ply", "ply\nformat ascii 1.0\n" + header + "end_header\n" + body);
    };
    const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
                      faces = "element face 1\nproperty list uchar float vertex_indices\n",
                      all = "0 0 0\n1 0 0\n0 1 0\n";
    CHECK(ply(vertices + faces, all + "3 0 1 2\n") == "no error");
    CHECK(ply(vertices + faces, all + "3 0 1.5 2\n") ==
          "a.ply:13:5: names vertex 1.5 of 3; vertices are whole numbers, and count from 0");
    CHECK(ply(vertices + faces, all + "3 0 nan 2\n").starts_with("a.ply:13:5: names vertex nan of 3"));
    CHECK(ply(vertices + faces, all + "3 0 1e30 2\n")
              .starts_with("a.ply:13:5: names vertex 1.0000000150474662e+30 of 3"));
    CHECK(ply(vertices + replaced(faces, "uchar", "float"), all + "2.5 0 1 2\n") ==
          "a.ply:13:1: the length of vertex_indices is 2.5; a whole number up to a million is read");
    CHECK(ply(vertices + faces, all + "3 0 1 2 1\n") == "a.ply:13:9: follows the last property of its element");
    CHECK(ply(vertices + faces, all + "3 0 1 2\n\n3 0 2 1\n") ==
          "a.ply:15:1: follows the last element that the header names");
    CHECK(ply(vertices + "elemnt face 1\n", all).starts_with("a.ply:7:1: \"elemnt\" begins no line of a header"));
    CHECK(ply(vertices + vertices, all).starts_with("a.ply:7:9: a second element \"vertex\""));
    CHECK(ply(vertices + "property float x\n", all).starts_with("a.ply:7:16: a second property \"x\""));
    CHECK(ply(vertices + faces + "property list uchar int vertex_index\n", all)
              .starts_with("a.ply:9:25: a second list of the corners"));
    CHECK(error_of_file("a.ply", "ply\n" + vertices + faces + "end_header\n" + all + "3 0 1 2\n")
              .starts_with("a.ply:8:1: the header has no line format"));
    CHECK(error_of_file("a.ply", "plx\n") == "a.ply:1:1: is not a PLY: its first line is not ply");
    const std::string bytes = as_ply_bytes<float>(scene::triangle::make_icosphere(0, {0, 0, 0}, 1), false);
    CHECK(has(error_of_file("a.ply", bytes + "abc"), ": 3 bytes follow the last element that the header names"));
}

TEST_CASE("a byte order mark is not a part of the text behind it", "[mesh]") {
    const Scratch folder;
    const Mesh ball = scene::triangle::make_icosphere(1, {0, 0, 0}, 1);
    const std::string mark = "\xEF\xBB\xBF";
    folder.write("ball.bin", buffer_of_gltf(ball));
    for (const auto& [name, text] :
         {std::pair{"a.obj", as_obj(ball)}, std::pair{"a.ply", as_ply_text<double>(ball)},
          std::pair{"a.stl", as_stl_text(ball)}, std::pair{"a.gltf", as_gltf(ball, R"(, "uri": "ball.bin")")}}) {
        INFO(name);
        const Mesh plain = read_mesh_file(folder.write(name, text));
        CHECK(are_same(read_mesh_file(folder.write(std::string("marked-") + name, mark + text)), plain));
    }
}

TEST_CASE("a number too small for its type is rounded as any other", "[mesh]") {
    const Scratch folder;
    const auto first_of = [&](const std::string& number) {
        return read_mesh_file(folder.write("a.obj", "v 7 7 " + number + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"))
            .triangle(0)
            .a.z;
    };
    CHECK(first_of("1e-400") == 0);
    CHECK(std::signbit(first_of("-1e-400")));
    CHECK(first_of("+1e-400") == 0);
    CHECK(first_of("2.4703282292062328e-324") == 0x1p-1074);  // above half of it
    CHECK(first_of("2.4703282292062327e-324") == 0);
    CHECK(first_of("1e-310") == 1e-310);
    CHECK(first_of("0." + std::string(400, '0') + "1") == 0);
    std::string text = as_ply_text<float>(scene::triangle::make_icosphere(0, {0, 0, 0}, 1));
    text = replaced(text, "255 0 ", "255 1e-60 ");
    CHECK(error_of_file("a.ply", text) == "no error");
    CHECK(has(error_of_file("a.ply", replaced(text, "1e-60", "1e60")), "x is \"1e60\", which overflows"));
}

TEST_CASE("a vertex that the scene cannot hold is refused at its place", "[mesh]") {
    const Scratch folder;
    Mesh vast = scene::triangle::make_fan(4, {0, 0, 0}, 1);
    vast.vertices[2].y = 0x1.ffffffp127;  // half an ulp above the largest: binary32 rounds it to infinity
    const auto error_with = [&](const FloatFormat& stored, const std::string& name, const std::string& bytes) {
        const auto path = folder.write(name, bytes);
        return error_in(folder, [&] { read_mesh_file(path, {.stop = {}, .stored = stored}); });
    };
    const std::string says =
        "overflows binary32, to which inputs = \"shared\" rounds; scale the mesh, or write inputs = "
        "\"own\"";
    CHECK(error_with(binary64, "a.obj", as_obj(vast)) == "no error");
    CHECK(has(error_with(binary32, "a.obj", as_obj(vast)), says));
    CHECK(
        error_with(binary32, "a.obj", as_obj(vast)).starts_with("a.obj:5:5: y is \"3.4028235677973366e+38\", which "));
    CHECK(has(error_with(binary32, "a.ply", as_ply_text<double>(vast)), says));
    CHECK(has(error_with(binary32, "a.ply", as_ply_bytes<double>(vast, true)), says));
    CHECK(has(error_with(binary32, "a.stl", as_stl_text(vast)), says));
    vast.vertices[2].y = 0x1.fffffep127;
    for (const auto& [name, bytes] :
         {std::pair{"a.obj", as_obj(vast)}, std::pair{"a.ply", as_ply_bytes<double>(vast, true)},
          std::pair{"a.stl", as_stl_text(vast)}})
        CHECK(error_with(binary32, name, bytes) == "no error");
}

TEST_CASE("what is no file is refused at once", "[mesh]") {
    const Scratch folder;
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.gltf", "a.glb"}) {
        INFO(name);
        const fs::path path = folder / name;
        const auto error = [&] { return error_in(folder, [&] { read_mesh_file(path); }); };
        CHECK(has(error(), "there is no such file"));
        REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
        CHECK(has(error(), "is a pipe or a device, and a file is read here"));
        fs::remove(path);
        fs::create_symlink("/dev/zero", path);
        CHECK(has(error(), "is a pipe or a device, and a file is read here"));
        fs::remove(path);
        fs::create_directory(path);
        CHECK(has(error(), "is a folder; name a file in it"));
        fs::remove(path);
        fs::create_symlink(name, path);
        CHECK(has(error(), "is not a file: "));
        fs::remove(path);
    }
}

TEST_CASE("a count of a header is held to the file before anything is made of it", "[mesh]") {
    const std::string header = "ply\nformat binary_little_endian 1.0\nelement junk 4294967295\n",
                      rest =
                          "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                          "property list uchar int vertex_indices\nend_header\n";
    CHECK(has(error_of_file("a.ply", header + rest), "element junk has no properties"));
    CHECK(has(error_of_file("a.ply", header + "property char c\n" + rest), "take at least 4294967295 bytes"));
    CHECK(
        has(error_of_file("a.ply", header + "property list uchar char c\n" + rest), "take at least 4294967295 bytes"));
    CHECK(has(error_of_file("a.ply", replaced(header + "property char c\n" + rest, "binary_little_endian", "ascii")),
              "take at least 8589934590 bytes"));
    std::string stl = as_stl_bytes(scene::triangle::make_icosphere(0, {0, 0, 0}, 1));
    stl[83] = '\xff';
    CHECK(has(error_of_file("a.stl", "x" + stl.substr(1)), "it would have 21"));
}

namespace {

/// A glTF of one triangle over `a.bin`, with one part of it replaced.
std::string small_gltf(const std::string& what = "", const std::string& by = "") {
    const std::string text =
        R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": "a.bin"}]})";
    return what.empty() ? text : replaced(text, what, by);
}
std::string small_buffer() {
    std::string bytes;
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) append(bytes, x);
    return bytes;
}

}  // namespace

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
          "a.gltf: nodes[0].translation: moves \"ball\", which would round its vertices; apply transforms before you "
          "export");
    CHECK(error_with(as_gltf(ball, buffer, R"(, "children": [0])"), bytes) ==
          "a.gltf: nodes[0].children[0]: names node 0 again; nodes are trees, and each stands in one place");
    CHECK(error_with(as_gltf(ball, buffer), bytes.substr(0, 100)) ==
          "a.gltf: buffers[0]: has 100 of its 384 bytes; was it cut short?");
    std::string wrong = bytes;
    wrong[3] = '\x7f';
    CHECK(error_with(as_gltf(ball, buffer), wrong).starts_with("a.gltf: accessors[0]: face 0 names vertex "));
    wrong = bytes;
    wrong.replace(wrong.size() - 4, 4, "\x00\x00\x80\x7f", 4);
    CHECK(error_with(as_gltf(ball, buffer), wrong) ==
          "a.gltf: accessors[1]: vertex 11, at byte 372 of its buffer, is not finite; a vertex has finite numbers");
    CHECK(error_with(replaced(as_gltf(ball, buffer), "5126", "5120"), bytes) ==
          "a.gltf: accessors[1]: is not three floats a vertex");
    CHECK(has(error_with(replaced(as_gltf(ball, buffer), "\"byteOffset\": 240", "\"byteOffset\": 300"), bytes),
              "a.gltf: bufferViews[1]: ends behind its buffer, which has 384 bytes; was it cut short?"));
    CHECK(has(error_with(replaced(as_gltf(ball, buffer), "\"count\": 12", "\"count\": 13"), bytes),
              "a.gltf: accessors[1]: has 13 elements, which end behind its buffer view of 144 bytes"));
    CHECK(error_with("{", bytes).starts_with("a.gltf:1:1: is not JSON: "));
    CHECK(error_with("{\n  \"asset\": ?}", bytes).starts_with("a.gltf:2:12: is not JSON: "));
    CHECK(error_with("[]", bytes) == "a.gltf: is not an object, and a glTF is one");
    CHECK(error_with("{}", bytes) == "a.gltf: has no asset");
}

TEST_CASE("a glTF is read in a time and in memory that go with its bytes", "[mesh]") {
    const Scratch folder;
    folder.write("a.bin", small_buffer());
    const auto error = [&](const std::string& json) {
        const auto path = folder.write("a.gltf", json);
        return error_in(folder, [&] { read_mesh_file(path); });
    };
    CHECK(error(small_gltf()) == "no error");
    const auto nested = [](int depth, char open, char close) {
        return small_gltf("\"2.0\"", "\"2.0\", \"extras\": " + std::string(static_cast<std::size_t>(depth), open) +
                                         std::string(static_cast<std::size_t>(depth), close));
    };
    CHECK(error(nested(50, '[', ']')) == "no error");
    CHECK(error(nested(15000, '[', ']')).starts_with("a.gltf:1:102: stands in more than 64 values"));
    CHECK(has(error(nested(1'000'000, '[', ']')), "stands in more than 64 values"));
    CHECK(has(error(std::string(15000, '[')), "stands in more than 64 values"));
    std::string nodes = "[";  // 2^40 ways lead to the last
    for (int i = 1; i <= 40; ++i) nodes += fmt::format(R"({{"children": [{}, {}]}}, )", i, i);
    CHECK(has(error(small_gltf("[{\"mesh\": 0}]", nodes + "{\"mesh\": 0}]")), "names node 40 again; nodes are trees"));
    // A hundred thousand nodes below each other take no stack.
    std::string chain = "[";
    for (int i = 1; i <= 100'000; ++i) chain += fmt::format(R"({{"children": [{}]}}, )", i);
    CHECK(error(small_gltf("[{\"mesh\": 0}]", chain + "{\"mesh\": 0}]")) == "no error");

    const std::string part = R"({"attributes": {"POSITION": 0}})";
    std::string parts = part;
    for (int i = 1; i < 20'000; ++i) parts += ", " + part;
    CHECK(error(small_gltf(part, parts)) ==
          "a.gltf: meshes[0].primitives[36]: makes more triangles than the buffers of the file have bytes; its "
          "primitives name the same numbers again and again");
    const Mesh shared = [&] { return read_mesh_file(folder.write("b.gltf", small_gltf(part, part + ", " + part))); }();
    CHECK(shared.faces.size() == 2);
    const std::string accessor = R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"})";
    std::string accessors = accessor, many = part;
    for (int i = 1; i < 20; ++i) {
        accessors += ", " + accessor;
        many += fmt::format(R"(, {{"attributes": {{"POSITION": {}}}}})", i);
    }
    CHECK(has(error(replaced(small_gltf(part, many), accessor, accessors)),
              "accessors[12]: makes more vertices than the buffers of the file have bytes"));
    CHECK(
        has(error(small_gltf("\"count\": 3", "\"count\": 18446744073709551615")), "which end behind its buffer view"));
    CHECK(has(error(small_gltf("\"count\": 3", "\"count\": -3")), "accessors[0].count: is not a whole number"));
}

TEST_CASE("a glTF opens what lies beside it and nothing else", "[mesh]") {
    const Scratch folder;
    folder.write("outside.bin", small_buffer());
    folder.write("in/a.bin", small_buffer());
    folder.write("in/sub/b c.bin", small_buffer());
    const auto error_with = [&](const std::string& uri) {
        const auto path = folder.write("in/a.gltf", small_gltf("a.bin", uri));
        return error_in(folder, [&] { read_mesh_file(path); });
    };
    CHECK(error_with("a.bin") == "no error");
    CHECK(error_with("./sub/b%20c.bin") == "no error");
    CHECK(error_with("data:application/octet-stream;base64,"
                     "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA") == "no error");
    CHECK(has(error_with("data:application/octet-stream;base64,AA*A"), "buffers[0].uri: is not base64"));
    const std::string outside = "lies outside of the folder of the glTF and is not opened";
    for (const std::string& uri : {(folder / "in/a.bin").string(), std::string("../outside.bin"),
                                   std::string("sub/../../outside.bin"), std::string("%2e%2e/outside.bin"),
                                   "file://" + (folder / "in/a.bin").string(), std::string("%2Fdev%2Fzero")}) {
        INFO(uri);
        CHECK(has(error_with(uri), outside));
    }
    CHECK(has(error_with("none.bin"), "buffers[0].uri: "));
    CHECK(has(error_with("sub"), "is a folder"));
    CHECK(has(error_with("a%00.bin"), "is not the name of a file"));
    // A picture is never wanted: a pipe in its place would keep whoever opens it waiting.
    const fs::path pipe = folder / "in/pipe.png";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    for (const std::string& image : {std::string("pipe.png"), pipe.string()}) {
        const auto path = folder.write(
            "in/a.gltf", small_gltf("\"nodes\": [{", "\"images\": [{\"uri\": \"" + image + "\"}], \"nodes\": [{"));
        CHECK(error_in(folder, [&] { read_mesh_file(path); }) == "no error");
    }
    CHECK(has(error_with("pipe.png"), "is a pipe or a device"));
}

TEST_CASE("every reader of meshes ends where the work is asked to", "[mesh]") {
    using scene::triangle::MeshBytes;
    const Scratch folder;
    const Mesh ball = scene::triangle::make_icosphere(5, {0, 0, 0}, 1);
    const std::string data = R"(, "uri": "ball.bin")";
    folder.write("ball.bin", buffer_of_gltf(ball));
    using Read = triangle::MeshInFile (*)(MeshBytes&, const triangle::MeshTerms&);
    const std::tuple<const char*, std::string, Read> files[] = {
        {"a.obj", as_obj(ball), triangle::read_obj},
        {"a.ply", as_ply_text<double>(ball), triangle::read_ply},
        {"b.ply", as_ply_bytes<float>(ball, true), triangle::read_ply},
        {"a.stl", as_stl_bytes(ball), triangle::read_stl},
        {"b.stl", as_stl_text(ball), triangle::read_stl},
        {"a.glb", as_glb(ball), triangle::read_gltf},
        {"a.gltf", as_gltf(ball, data), triangle::read_gltf}};
    for (const auto& [name, bytes, read] : files) {
        INFO(name);
        std::atomic<bool> asked{false};
        const intersect::process::StopToken stop(asked);
        const auto path = folder.write(name, bytes);
        MeshBytes opened(path, stop);
        asked = true;  // after the file is opened, as when the signal comes on the way
        CHECK_THROWS_AS(read(opened, {.stop = stop}), Interrupted);
        CHECK_THROWS_AS(read_mesh_file(path, {.stop = stop}), Interrupted);
    }
    std::atomic<bool> asked{true};
    Mesh mesh = ball;
    CHECK_THROWS_AS(tidy(
                        mesh, [](std::size_t) { return std::string(); }, intersect::process::StopToken(asked)),
                    Interrupted);
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
