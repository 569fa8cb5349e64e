#include "shapes/triangle/mesh/mesh_file.hpp"

#include "number/error.hpp"

namespace lostbits::scene::triangle {

Mesh read_mesh_file(const std::filesystem::path& path) {
    throw InputError(path.string() + ": meshes are not read yet");
}

}  // namespace lostbits::scene::triangle
