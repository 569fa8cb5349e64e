// Reads files of meshes: OBJ, PLY, STL and glTF.
#pragma once

#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::scene::triangle {

/// Reads the mesh of a file and tidies it. The extension of the name gives the format: .obj, .ply, .stl, .gltf or .glb.
/// A decimal number is rounded once to binary64, and a binary32 number is kept exactly. A face of more than three
/// corners becomes a fan around its first corner. Throws InputError with `line:column`, the byte, or the path inside a
/// glTF if the file is not a mesh. Memory is at most a small multiple of the file's bytes. Only regular files are
/// opened.
Mesh read_mesh_file(const std::filesystem::path& path, const MeshSettings& settings = {});

}  // namespace lostbits::scene::triangle
