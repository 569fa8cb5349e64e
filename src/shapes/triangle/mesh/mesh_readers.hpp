// The readers of mesh files, one for each format.
#pragma once

#include <span>

#include "shapes/triangle/mesh/mesh.hpp"
#include "shapes/triangle/mesh/mesh_bytes.hpp"

namespace lostbits::scene::triangle {

/// A mesh as a file gives it, with the position of each face: its line, or its index if the file has no lines.
struct ParsedMesh {
    Mesh mesh;
    std::vector<std::uint32_t> lines = {};

    /// Adds a face of `corners`, as a fan around the first.
    void add(std::span<const std::uint32_t> corners, std::size_t line) {
        for (std::size_t k = 2; k < corners.size(); ++k) {
            mesh.faces.push_back({corners[0], corners[k - 1], corners[k]});
            lines.push_back(static_cast<std::uint32_t>(line));
        }
    }
};

inline constexpr std::size_t max_vertices = 0xffffffff;  ///< indices are 32 bits wide
inline constexpr std::size_t max_faces = 0x7fffffff;     ///< indices of faces are signed

/// Reads `v` and `f` of a Wavefront OBJ. Ignores the texture and normal of a corner, and all other lines that OBJ
/// allows.
ParsedMesh read_obj(MeshBytes& bytes, const MeshSettings& settings);
/// Reads PLY 1.0: the element `vertex` with `x`, `y`, `z`, and `face` with a list `vertex_indices` or `vertex_index`.
ParsedMesh read_ply(MeshBytes& bytes, const MeshSettings& settings);
/// Reads STL in ASCII or binary. The size distinguishes them: a binary file of n facets has 84 + 50 n bytes.
ParsedMesh read_stl(MeshBytes& bytes, const MeshSettings& settings);
/// Reads glTF 2.0, as JSON or as one binary file: the triangles of the default scene, or of all meshes if there is no
/// scene. A node that moves its mesh is an error, because its vertices would be rounded. Buffers are read from the
/// folder of the file or below it, and nothing else is opened.
ParsedMesh read_gltf(MeshBytes& bytes, const MeshSettings& settings);

}  // namespace lostbits::scene::triangle
