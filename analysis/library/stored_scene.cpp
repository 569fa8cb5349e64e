// The primitives of a scene in the numbers of a format, kept from call to call.
#include "analysis/library/handles.hpp"
#include "scene/rays/stored_mesh.hpp"

namespace lostbits::analysis::library {

using scene::file::Scene;

scene::rays::PrimitiveList<double> primitive_list(std::vector<Primitive<double>> primitives,
                                                  std::shared_ptr<const scene::rays::StoredMesh> mesh) {
    scene::rays::RayGroup group;
    group.primitives = std::move(primitives);
    group.mesh = std::move(mesh);
    return scene::rays::primitive_list_of(group);
}

SceneInFormat::SceneInFormat(const Scene& scene, const FloatFormat& format)
    : primitives_beside_mesh(scene::rays::make_stored_primitives_beside_mesh(scene, format)),
      mesh(scene::rays::make_stored_mesh(scene, format)) {}

const measure::culling::Culler& SceneInFormat::culler() const {
    std::call_once(culler_made_, [this] { culler_.emplace(primitive_list(primitives_beside_mesh, mesh)); });
    return *culler_;
}

std::shared_ptr<const SceneInFormat> SceneCache::get(const Scene& scene, const FloatFormat& format) {
    if (!scene.mesh) return std::make_shared<const SceneInFormat>(scene, format);
    const std::scoped_lock lock(mutex_);
    auto& stored = scenes_[{format.precision, format.emin, format.emax}];
    if (!stored) stored = std::make_shared<const SceneInFormat>(scene, format);
    return stored;
}

}  // namespace lostbits::analysis::library
