// The mesh of a scene in the numbers in which it is stored.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "scene/rays/primitive_list.hpp"

namespace lostbits::scene::rays {

/// The triangles of meshes, which are the last of `make_stored_primitives`; null if the scene has no mesh.
inline std::shared_ptr<const StoredMesh> make_stored_mesh(const file::Scene& scene, const FloatFormat& format) {
    if (!scene.mesh || scene.inputs == file::InputRounding::shared) return make_shared_mesh(scene);
    const auto stored = [&format](double x) { return rounding::to_format(x, 0, format); };
    const auto mesh = std::make_shared<triangle::Mesh>(*scene.mesh);
    for (Vec<double>& v : mesh->vertices)
        for (int k = 0; k < 3; ++k) v[k] = stored(v[k]);
    auto transform = scene.mesh_transform;
    if (transform) transform = convert_numbers(*transform, stored);
    return std::make_shared<const StoredMesh>(mesh, transform, file::InputRounding::own);
}

/// The primitives of `make_stored_primitives` that are not triangles of meshes.
inline std::vector<Primitive<double>> make_stored_primitives_beside_mesh(const file::Scene& scene,
                                                                         const FloatFormat& format) {
    file::Scene without_mesh = scene;
    without_mesh.mesh = nullptr;
    return make_stored_primitives(without_mesh, format);
}

/// The primitives and at most two triangles of the mesh. They stand for all primitives where only two facts matter:
/// which shapes there are, and whether there is more than one primitive.
inline std::vector<Primitive<double>> representatives_of(std::vector<Primitive<double>> primitives,
                                                         const StoredMesh* mesh) {
    for (std::size_t i = 0; mesh != nullptr && i < std::min<std::size_t>(mesh->size(), 2); ++i)
        primitives.push_back((*mesh)[i]);
    return primitives;
}

/// True if binary32 represents every number of the triangles.
inline bool fits_binary32(const StoredMesh& triangles) {
    bool fits = true;
    const auto check_number = [&fits](double x) {
        fits &= static_cast<double>(static_cast<float>(x)) == x;
        return x;
    };
    for (std::size_t i = 0; fits && i < triangles.size(); ++i)
        static_cast<void>(convert_numbers(triangles[i], check_number));
    return fits;
}

}  // namespace lostbits::scene::rays
