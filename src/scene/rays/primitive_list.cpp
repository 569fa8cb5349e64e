#include "scene/rays/primitive_list.hpp"

#include "scene/rays/rays.hpp"
#include "scene/rays/stored_mesh.hpp"

namespace lostbits::scene::rays {
namespace {

template <class T>
std::array<std::vector<T>, 4> make_sphere_columns(const sphere::Sphereflake& flake, const FloatFormat& f) {
    std::array<std::vector<T>, 4> columns;
    for (std::vector<T>& column : columns) column.reserve(flake.size());
    sphere::for_each_primitive(flake, [&](const Primitive<double>& s) {
        const Primitive<double> stored = round_primitive(s, f);
        for (std::size_t k = 0; k < 4; ++k) columns[k].push_back(static_cast<T>(stored.numbers[k]));
    });
    return columns;
}

template <class S>
PrimitiveList<S> with_flake_and_mesh(std::vector<Primitive<S>> listed, const file::Scene& scene) {
    typename PrimitiveList<S>::FlakeAndMesh flake_and_mesh{.flake = {}, .mesh = {}, .inputs = scene.inputs};
    if (scene.flake) {
        sphere::require_memory_for(*scene.flake);
        flake_and_mesh.flake = std::make_shared<const SphereColumns>(*scene.flake, scene.inputs);
    }
    if (scene.mesh)
        flake_and_mesh.mesh = std::make_shared<const MeshColumns>(scene.mesh, scene.mesh_transform, scene.inputs);
    return {std::move(listed), std::move(flake_and_mesh)};
}

template <class S>
PrimitiveList<double> round_list(const PrimitiveList<S>& primitives, const FloatFormat& f) {
    std::vector<Primitive<double>> listed;
    for (const Primitive<S>& s : primitives.listed()) listed.push_back(round_primitive(s, f));
    const FloatFormat& stored_format = primitives.flake_and_mesh().inputs == file::Inputs::shared ? binary32 : binary64;
    const bool holds_stored =
        f.precision >= stored_format.precision && f.emin <= stored_format.emin && f.emax >= stored_format.emax;
    const auto& [flake, mesh, inputs] = primitives.flake_and_mesh();
    return {std::move(listed), {flake, mesh, inputs}, holds_stored ? std::nullopt : std::optional(f)};
}

}  // namespace

SphereColumns::SphereColumns(const sphere::Sphereflake& flake, file::Inputs inputs) {
    if (inputs == file::Inputs::shared) columns_ = make_sphere_columns<float>(flake, binary32);
    else columns_ = make_sphere_columns<double>(flake, binary64);
}

MeshColumns::MeshColumns(std::shared_ptr<const triangle::Mesh> mesh, std::optional<Transform<double>> transform,
                         file::Inputs inputs)
    : mesh_(std::move(mesh)), vertices_(mesh_->vertices), transform_(std::move(transform)) {
    if (inputs == file::Inputs::own) return;
    const auto stored = [](double x) { return rounding::to_format(x, 0, binary32); };
    for (Vec<double>& v : vertices_)
        for (int k = 0; k < 3; ++k) v[k] = stored(v[k]);
    if (transform_) transform_ = convert_numbers(*transform_, stored);
}

void MeshColumns::prefetch(std::span<const std::uint32_t> triangles, std::size_t first) const {
    for (const std::uint32_t i : triangles)
        if (i >= first) __builtin_prefetch(&mesh_->faces[i - first]);
    for (const std::uint32_t i : triangles) {
        if (i < first) continue;
        for (const std::uint32_t corner : mesh_->faces[i - first]) __builtin_prefetch(&vertices_[corner]);
    }
}

std::vector<Primitive<double>> shared_listed(const file::Scene& scene) {
    std::vector<Primitive<double>> listed;
    for (const Primitive<Real>& primitive : scene.listed) listed.push_back(round_primitive(primitive, binary32));
    return listed;
}

std::shared_ptr<const MeshColumns> shared_mesh(const file::Scene& scene) {
    return scene.mesh ? std::make_shared<const MeshColumns>(scene.mesh, scene.mesh_transform, file::Inputs::shared)
                      : nullptr;
}

PrimitiveList<double> shared_primitive_list(const file::Scene& scene) {
    return with_flake_and_mesh(shared_listed(scene), scene);
}

PrimitiveList<double> primitive_list_of(const RayGroup& group) {
    const bool is_wide = group.mesh && !fits_binary32(*group.mesh);
    return {group.primitives,
            {.flake = {}, .mesh = group.mesh, .inputs = is_wide ? file::Inputs::own : file::Inputs::shared}};
}

PrimitiveList<Real> ideal_primitive_list(const file::Scene& scene) { return with_flake_and_mesh(scene.listed, scene); }

PrimitiveList<double> round_primitives(const PrimitiveList<double>& primitives, const FloatFormat& f) {
    return round_list(primitives, f);
}
PrimitiveList<double> round_primitives(const PrimitiveList<Real>& primitives, const FloatFormat& f) {
    return round_list(primitives, f);
}

}  // namespace lostbits::scene::rays
