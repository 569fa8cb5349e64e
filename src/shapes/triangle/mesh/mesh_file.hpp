// Files of meshes: OBJ, PLY, STL and glTF.
#pragma once

#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::scene::triangle {

/// The mesh of a file, told by the end of its name: .obj, .ply, .stl, .gltf or .glb; tidied. Vertices arrive with the
/// bits of the file: a decimal is rounded once to binary64, a binary32 number is kept. A face of more than three
/// corners becomes a fan around its first. InputError with `line:column`, the byte, or the way through a glTF for what
/// makes no mesh. No file takes more memory than a small multiple of its bytes, and none that is not a file is opened.
Mesh read_mesh_file(const std::filesystem::path& path, const MeshTerms& terms = {});

}  // namespace lostbits::scene::triangle
