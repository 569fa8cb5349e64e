// A mesh as text or bytes in each format that is read, for the tests of files of meshes.
#pragma once

#include <cmath>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "number/random.hpp"
#include "scene/scene_text.hpp"
#include "shapes/triangle/mesh/mesh_file.hpp"

namespace lostbits::scene::test {

using scene::triangle::Mesh;
using scene::triangle::read_mesh_file;

template <class T>
void append(std::string& to, T x, bool turned = false) {
    char raw[sizeof x];
    std::memcpy(raw, &x, sizeof x);
    if (turned) std::reverse(std::begin(raw), std::end(raw));
    to.append(raw, sizeof x);
}

inline std::string to_obj(const Mesh& mesh) {
    std::string text = "# an object\no ball\n";
    for (const auto& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
    for (const auto& [a, b, c] : mesh.faces)
        text += fmt::format("f {}/1/1 {}//2 {}\n", a + 1, b + 1,
                            static_cast<long>(c) - static_cast<long>(mesh.vertices.size()));
    return text;
}

inline std::string ply_header(const char* format, const char* type, const Mesh& mesh) {
    return fmt::format(
        "ply\nformat {} 1.0\ncomment made by a test\nelement vertex {}\nproperty uchar red\nproperty {} x\nproperty {} "
        "y\n"
        "property {} z\nelement face {}\nproperty list uchar uint vertex_indices\nelement edge 1\nproperty int "
        "vertex1\n"
        "end_header\n",
        format, mesh.vertices.size(), type, type, type, mesh.faces.size());
}

template <class T>
inline std::string to_ply_text(const Mesh& mesh) {
    std::string text = ply_header("ascii", sizeof(T) == 4 ? "float" : "double", mesh);
    for (const auto& v : mesh.vertices)
        text += fmt::format("255 {} {} {}\n", static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z));
    for (const auto& [a, b, c] : mesh.faces) text += fmt::format("3 {} {} {}\n", a, b, c);
    return text + "7\n";
}

template <class T>
inline std::string to_ply_bytes(const Mesh& mesh, bool big) {
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

inline std::string to_stl_bytes(const Mesh& mesh) {
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

inline std::string to_stl_text(const Mesh& mesh) {
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

/// The JSON of a mesh whose buffer begins with the indices (uint32) and then has the vertices; `buffer` says where it
/// is.
inline std::string to_gltf(const Mesh& mesh, const std::string& buffer, const std::string& node = "") {
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
inline std::string buffer_of_gltf(const Mesh& mesh) {
    std::string bytes;
    for (const auto& face : mesh.faces)
        for (const std::uint32_t corner : face) append(bytes, corner);
    for (const auto& v : mesh.vertices)
        for (int k = 0; k < 3; ++k) append(bytes, static_cast<float>(v[k]));
    return bytes;
}
inline std::string to_glb(const Mesh& mesh) {
    std::string json = to_gltf(mesh, ""), buffer = buffer_of_gltf(mesh), all = "glTF";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    append(all, std::uint32_t{2});
    append(all, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
    append(all, static_cast<std::uint32_t>(json.size()));
    all += "JSON" + json;
    append(all, static_cast<std::uint32_t>(buffer.size()));
    return all + std::string("BIN\0", 4) + buffer;
}

/// A fan of triangles whose corners are random numbers of any exponent that a cross product of floats survives.
inline Mesh draw_mesh(bool of_binary32) {
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

inline bool are_same(const Mesh& a, const Mesh& b) {
    if (a.faces.size() != b.faces.size()) return false;
    for (std::size_t f = 0; f < a.faces.size(); ++f) {
        const auto x = a.triangle(f), y = b.triangle(f);
        if (x.a != y.a || x.b != y.b || x.c != y.c) return false;
    }
    return true;
}

inline std::string error_of_file(const std::string& name, const std::string& bytes) {
    const Scratch folder;
    const auto path = folder.write(name, bytes);
    return error_in(folder, [&] { read_mesh_file(path); });
}

}  // namespace lostbits::scene::test
