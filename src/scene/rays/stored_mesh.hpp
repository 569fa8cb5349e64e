// The mesh of a scene in the numbers in which it is stored.
#pragma once

#include <memory>

#include "scene/rays/solid_list.hpp"

namespace lostbits::scene::rays {

/// The triangles of meshes, which are the last of `stored_solids`; null if there are none.
inline std::shared_ptr<const MeshColumns> stored_mesh(const file::Scene& scene, const FloatFormat& f) {
    if (!scene.mesh || scene.inputs == file::Inputs::shared) return shared_mesh(scene);
    const auto stored = [&f](double x) { return rounding::to_format(x, 0, f); };
    const auto mesh = std::make_shared<triangle::Mesh>(*scene.mesh);
    for (Vec<double>& v : mesh->vertices)
        for (int k = 0; k < 3; ++k) v[k] = stored(v[k]);
    auto placed = scene.mesh_placed;
    if (placed) placed = transformed(*placed, stored);
    return std::make_shared<const MeshColumns>(mesh, placed, file::Inputs::own);
}

/// True if binary32 holds every number of the triangles.
inline bool fits_binary32(const MeshColumns& triangles) {
    bool fits = true;
    const auto look = [&fits](double x) {
        fits &= static_cast<double>(static_cast<float>(x)) == x;
        return x;
    };
    for (std::size_t i = 0; fits && i < triangles.size(); ++i) static_cast<void>(transformed(triangles[i], look));
    return fits;
}

}  // namespace lostbits::scene::rays
