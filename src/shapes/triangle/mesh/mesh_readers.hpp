// The readers of files of meshes, one a format.
#pragma once

#include <istream>

#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::scene::triangle {

/// A mesh as a file gives it, with a place for each face: a line, or the number of the face where a file has no lines.
struct MeshInFile {
    Mesh mesh;
    std::vector<std::uint32_t> lines = {};

    /// Adds a face of `corners`, as a fan around the first.
    void add(const std::vector<std::uint32_t>& corners, std::size_t line) {
        for (std::size_t k = 2; k < corners.size(); ++k) {
            mesh.faces.push_back({corners[0], corners[k - 1], corners[k]});
            lines.push_back(static_cast<std::uint32_t>(line));
        }
    }
};

inline constexpr std::size_t most_vertices = 0xffffffff;  ///< places are 32 bits wide

/// `v` and `f` of a Wavefront OBJ; texture and normal of a corner, and all other lines, are left aside.
MeshInFile read_obj(const std::filesystem::path& path, std::istream& bytes);
/// PLY 1.0: the element `vertex` with `x`, `y`, `z`, and `face` with a list `vertex_indices` or `vertex_index`.
MeshInFile read_ply(const std::filesystem::path& path, std::istream& bytes);
/// STL, in text or bytes; told apart by the size, which in bytes is 84 + 50 n.
MeshInFile read_stl(const std::filesystem::path& path, std::istream& bytes);
/// glTF 2.0, as JSON or as one binary: the triangles of the default scene, or of all meshes where there is none. A node
/// that moves its mesh is an error: vertices would be rounded. The file is opened again by its path.
MeshInFile read_gltf(const std::filesystem::path& path, std::istream& bytes);

}  // namespace lostbits::scene::triangle
