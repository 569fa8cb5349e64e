// The rays and primitives that a call gives as arrays.
#pragma once

#include <memory>
#include <vector>

#include "analysis/library/handles.hpp"
#include "analysis/library/ray_arrays.hpp"
#include "scene/rays/rays.hpp"
#include "scene/rays/stored_mesh.hpp"

namespace lostbits::analysis::library {

inline constexpr const char* rays_name = "rays";  ///< of the arrays, in messages

/// The rays of the caller: the arrays as a ray file, and the primitives that all rays share.
struct GivenRays {
    std::unique_ptr<RayArrays> ray_file;
    /// Primitives that all rays share. Without a mesh, an empty list means that each ray has its own primitive.
    std::vector<Primitive<double>> primitives = {};
    /// The triangles of the mesh come after `primitives`; null: no mesh.
    std::shared_ptr<const scene::rays::StoredMesh> mesh = {};
    std::shared_ptr<const SceneInFormat> stored = {};  ///< the scene with these primitives; null: they are from arrays
    Shape shape{};                                     ///< of the first primitive
    [[nodiscard]] std::vector<Primitive<double>> representatives() const {
        return scene::rays::representatives_of(primitives, mesh.get());
    }
};

/// Reads the arrays. Throws InputError for arrays and primitives that do not fit.
GivenRays read_rays(const lostbits_rays& rays, const CallSettings& settings);

}  // namespace lostbits::analysis::library
