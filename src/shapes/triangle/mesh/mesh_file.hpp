// Files of meshes: OBJ, PLY and STL.
#pragma once

#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::scene::triangle {

/// The mesh of a file, told by the end of its name: .obj, .ply or .stl; tidied. Vertices arrive with the
/// bits of the file: a decimal is rounded once to binary64, a binary32 number is kept. A face of more than three
/// corners becomes a fan around its first. InputError with the line or the byte for what makes no mesh.
Mesh read_mesh_file(const std::filesystem::path& path);

}  // namespace lostbits::scene::triangle
