// Files that are not meshes, or that declare more than they contain: time and memory are proportional to their bytes.
#include <sys/stat.h>

#include <atomic>
#include <tuple>

#include "catch.hpp"
#include "scene/file/mesh_text.hpp"
#include "shapes/triangle/mesh/made.hpp"
#include "shapes/triangle/mesh/mesh_readers.hpp"

namespace test_mesh_limits {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::test;

TEST_CASE("a path that is not a regular file is refused at once", "[mesh]") {
    const Scratch folder;
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.gltf", "a.glb"}) {
        INFO(name);
        const fs::path path = folder / name;
        const auto error = [&] { return error_in(folder, [&] { read_mesh_file(path); }); };
        CHECK(has(error(), "no such file"));
        REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
        CHECK(has(error(), "is a pipe or a device, but a file is needed here"));
        fs::remove(path);
        fs::create_symlink("/dev/zero", path);
        CHECK(has(error(), "is a pipe or a device, but a file is needed here"));
        fs::remove(path);
        fs::create_directory(path);
        CHECK(has(error(), "is a folder; name a file in it"));
        fs::remove(path);
        fs::create_symlink(name, path);
        CHECK(has(error(), "is not a file: "));
        fs::remove(path);
    }
}

TEST_CASE("a count in a header is checked against the file size before memory is taken", "[mesh]") {
    const std::string header = "ply\nformat binary_little_endian 1.0\nelement junk 4294967295\n",
                      rest =
                          "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                          "property list uchar int vertex_indices\nend_header\n";
    CHECK(has(error_of_file("a.ply", header + rest), "element junk has no properties"));
    CHECK(has(error_of_file("a.ply", header + "property char c\n" + rest), "take at least 4294967295 bytes"));
    CHECK(
        has(error_of_file("a.ply", header + "property list uchar char c\n" + rest), "take at least 4294967295 bytes"));
    CHECK(
        has(error_of_file("a.ply", replace_text(header + "property char c\n" + rest, "binary_little_endian", "ascii")),
            "take at least 8589934590 bytes"));
    std::string stl = to_stl_bytes(scene::triangle::make_icosphere(0, {0, 0, 0}, 1));
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
    return what.empty() ? text : replace_text(text, what, by);
}
std::string small_buffer() {
    std::string bytes;
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) append(bytes, x);
    return bytes;
}

}  // namespace

TEST_CASE("a glTF file that transforms its mesh or refers to a remote buffer is refused", "[mesh]") {
    const Scratch folder;
    const Mesh ball = scene::triangle::make_icosphere(0, {0, 0, 0}, 1);
    const std::string buffer = R"(, "uri": "a.bin")", bytes = buffer_of_gltf(ball);
    const auto error_with = [&](const std::string& json, const std::string& bin) {
        folder.write("a.bin", bin);
        const auto path = folder.write("a.gltf", json);
        return error_in(folder, [&] { read_mesh_file(path); });
    };
    CHECK(error_with(to_gltf(ball, buffer), bytes) == "no error");
    CHECK(error_with(to_gltf(ball, buffer, R"(, "translation": [0, 0, 0])"), bytes) == "no error");
    CHECK(error_with(to_gltf(ball, buffer, R"(, "name": "ball", "translation": [0, 0, 1e-9])"), bytes) ==
          "a.gltf: nodes[0].translation: moves \"ball\", which would round its vertices; apply transforms before you "
          "export");
    CHECK(error_with(to_gltf(ball, buffer, R"(, "children": [0])"), bytes) ==
          "a.gltf: nodes[0].children[0]: names node 0 again; nodes form trees, and each node has one parent");
    CHECK(error_with(to_gltf(ball, buffer), bytes.substr(0, 100)) ==
          "a.gltf: buffers[0]: has 100 of its 384 bytes; was it cut short?");
    std::string wrong = bytes;
    wrong[3] = '\x7f';
    CHECK(error_with(to_gltf(ball, buffer), wrong).starts_with("a.gltf: accessors[0]: face 0 names vertex "));
    wrong = bytes;
    wrong.replace(wrong.size() - 4, 4, "\x00\x00\x80\x7f", 4);
    CHECK(error_with(to_gltf(ball, buffer), wrong) ==
          "a.gltf: accessors[1]: vertex 11, at byte 372 of its buffer, is not finite; a vertex has finite numbers");
    CHECK(error_with(replace_text(to_gltf(ball, buffer), "5126", "5120"), bytes) ==
          "a.gltf: accessors[1]: does not hold three floats for each vertex");
    CHECK(has(error_with(replace_text(to_gltf(ball, buffer), "\"byteOffset\": 240", "\"byteOffset\": 300"), bytes),
              "a.gltf: bufferViews[1]: ends beyond its buffer, which has 384 bytes; was it cut short?"));
    CHECK(has(error_with(replace_text(to_gltf(ball, buffer), "\"count\": 12", "\"count\": 13"), bytes),
              "a.gltf: accessors[1]: has 13 elements, which end beyond its buffer view of 144 bytes"));
    CHECK(error_with("{", bytes).starts_with("a.gltf:1:1: is not JSON: "));
    CHECK(error_with("{\n  \"asset\": ?}", bytes).starts_with("a.gltf:2:12: is not JSON: "));
    CHECK(error_with(to_gltf(ball, buffer) + '\0' + "x", bytes)
              .ends_with("has a zero byte with more text after it; is it a text file?"));
    CHECK(error_with(to_gltf(ball, buffer) + std::string(3, '\0'), bytes) == "no error");
    CHECK(error_with(to_gltf(ball, buffer) + "x", bytes).find("is not JSON: ") != std::string::npos);
    CHECK(error_with(replace_text(to_gltf(ball, buffer), "\"asset\"",
                                  R"("extensionsRequired": ["KHR_mesh_quantization", "EXT_x"], "asset")"),
                     bytes) ==
          "a.gltf: extensionsRequired: names \"KHR_mesh_quantization\", \"EXT_x\", which are not supported; export the "
          "mesh without them");
    CHECK(error_with("[]", bytes) == "a.gltf: is not a JSON object; a glTF file is one");
    CHECK(error_with("{}", bytes) == "a.gltf: has no asset");
}

TEST_CASE("a glTF file is read in time and memory proportional to its bytes", "[mesh]") {
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
    CHECK(error(nested(15000, '[', ']')).starts_with("a.gltf:1:102: is nested in more than 64 values"));
    CHECK(has(error(nested(1'000'000, '[', ']')), "is nested in more than 64 values"));
    CHECK(has(error(std::string(15000, '[')), "is nested in more than 64 values"));
    std::string nodes = "[";  // 2^40 ways lead to the last
    for (int i = 1; i <= 40; ++i) nodes += fmt::format(R"({{"children": [{}, {}]}}, )", i, i);
    CHECK(has(error(small_gltf("[{\"mesh\": 0}]", nodes + "{\"mesh\": 0}]")), "names node 40 again; nodes form trees"));
    // Twenty thousand nested nodes use no stack.
    std::string chain = "[";
    for (int i = 1; i <= 20'000; ++i) chain += fmt::format(R"({{"children": [{}]}}, )", i);
    CHECK(error(small_gltf("[{\"mesh\": 0}]", chain + "{\"mesh\": 0}]")) == "no error");

    const std::string part = R"({"attributes": {"POSITION": 0}})";
    std::string parts = part;
    for (int i = 1; i < 20'000; ++i) parts += ", " + part;
    CHECK(error(small_gltf(part, parts)) ==
          "a.gltf: meshes[0].primitives[36]: makes more triangles than the buffers of the file have bytes; its "
          "primitives use the same numbers again and again");
    const Mesh shared = [&] { return read_mesh_file(folder.write("b.gltf", small_gltf(part, part + ", " + part))); }();
    CHECK(shared.faces.size() == 2);
    const std::string accessor = R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"})";
    std::string accessors = accessor, many = part;
    for (int i = 1; i < 20; ++i) {
        accessors += ", " + accessor;
        many += fmt::format(R"(, {{"attributes": {{"POSITION": {}}}}})", i);
    }
    CHECK(has(error(replace_text(small_gltf(part, many), accessor, accessors)),
              "accessors[12]: makes more vertices than the buffers of the file have bytes"));
    CHECK(
        has(error(small_gltf("\"count\": 3", "\"count\": 18446744073709551615")), "which end beyond its buffer view"));
    CHECK(has(error(small_gltf("\"count\": 3", "\"count\": -3")), "accessors[0].count: is not a whole number"));
}

TEST_CASE("a glTF file opens files in its own folder only", "[mesh]") {
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
    const std::string outside = "is outside the folder of the glTF and is not opened";
    for (const std::string& uri : {(folder / "in/a.bin").string(), std::string("../outside.bin"),
                                   std::string("sub/../../outside.bin"), std::string("%2e%2e/outside.bin"),
                                   "file://" + (folder / "in/a.bin").string(), std::string("%2Fdev%2Fzero")}) {
        INFO(uri);
        CHECK(has(error_with(uri), outside));
    }
    CHECK(has(error_with("none.bin"), "buffers[0].uri: "));
    CHECK(has(error_with("sub"), "is a folder"));
    CHECK(has(error_with("a%00.bin"), "is not the name of a file"));
    // Pictures are never read: a pipe in place of one would block whoever opens it.
    const fs::path pipe = folder / "in/pipe.png";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    for (const std::string& image : {std::string("pipe.png"), pipe.string()}) {
        const auto path = folder.write(
            "in/a.gltf", small_gltf("\"nodes\": [{", "\"images\": [{\"uri\": \"" + image + "\"}], \"nodes\": [{"));
        CHECK(error_in(folder, [&] { read_mesh_file(path); }) == "no error");
    }
    CHECK(has(error_with("pipe.png"), "is a pipe or a device"));
}

TEST_CASE("every mesh reader stops on request", "[mesh]") {
    using scene::triangle::MeshBytes;
    const Scratch folder;
    const Mesh ball = scene::triangle::make_icosphere(5, {0, 0, 0}, 1);
    const std::string data = R"(, "uri": "ball.bin")";
    folder.write("ball.bin", buffer_of_gltf(ball));
    using Read = triangle::ParsedMesh (*)(MeshBytes&, const triangle::MeshSettings&);
    const std::tuple<const char*, std::string, Read> files[] = {
        {"a.obj", to_obj(ball), triangle::read_obj},
        {"a.ply", to_ply_text<double>(ball), triangle::read_ply},
        {"b.ply", to_ply_bytes<float>(ball, true), triangle::read_ply},
        {"a.stl", to_stl_bytes(ball), triangle::read_stl},
        {"b.stl", to_stl_text(ball), triangle::read_stl},
        {"a.glb", to_glb(ball), triangle::read_gltf},
        {"a.gltf", to_gltf(ball, data), triangle::read_gltf}};
    for (const auto& [name, bytes, read] : files) {
        INFO(name);
        std::atomic<bool> stop_requested{false};
        const intersect::process::StopToken stop(stop_requested);
        const auto path = folder.write(name, bytes);
        MeshBytes opened(path, stop);
        stop_requested = true;  // after the file is opened, as when the signal comes on the way
        CHECK_THROWS_AS(read(opened, {.stop = stop}), Interrupted);
        CHECK_THROWS_AS(read_mesh_file(path, {.stop = stop}), Interrupted);
    }
    std::atomic<bool> stop_requested{true};
    Mesh mesh = ball;
    CHECK_THROWS_AS(merge_and_count(
                        mesh, [](std::size_t) { return std::string(); }, intersect::process::StopToken(stop_requested)),
                    Interrupted);
}

}  // namespace test_mesh_limits
