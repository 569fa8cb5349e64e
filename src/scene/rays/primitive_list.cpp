#include "scene/rays/primitive_list.hpp"

#include "scene/rays/rays.hpp"
#include "scene/rays/stored_mesh.hpp"

namespace lostbits::scene::rays {
namespace {

template <class T>
std::array<std::vector<T>, 4> make_sphere_columns(const sphere::Sphereflake& flake, const FloatFormat& format) {
    std::array<std::vector<T>, 4> columns;
    for (std::vector<T>& column : columns) column.reserve(flake.size());
    sphere::for_each_primitive(flake, [&](const Primitive<double>& primitive) {
        const Primitive<double> stored = round_primitive(primitive, format);
        for (std::size_t k = 0; k < 4; ++k) columns[k].push_back(static_cast<T>(stored.numbers[k]));
    });
    return columns;
}

template <class S>
PrimitiveList<S> make_list_with_flake_and_mesh(std::vector<Primitive<S>> listed, const file::Scene& scene) {
    typename PrimitiveList<S>::FlakeAndMesh flake_and_mesh{.flake = {}, .mesh = {}, .inputs = scene.inputs};
    if (scene.flake) {
        sphere::require_memory_for(*scene.flake);
        flake_and_mesh.flake = std::make_shared<const SphereColumns>(*scene.flake, scene.inputs);
    }
    if (scene.mesh)
        flake_and_mesh.mesh = std::make_shared<const StoredMesh>(scene.mesh, scene.mesh_transform, scene.inputs);
    return {std::move(listed), std::move(flake_and_mesh)};
}

template <class S>
PrimitiveList<double> round_list(const PrimitiveList<S>& primitives, const FloatFormat& format) {
    std::vector<Primitive<double>> listed;
    for (const Primitive<S>& primitive : primitives.listed_primitives())
        listed.push_back(round_primitive(primitive, format));
    const FloatFormat& stored_format =
        primitives.flake_and_mesh().inputs == file::InputRounding::shared ? binary32 : binary64;
    const bool holds_stored = format.precision >= stored_format.precision && format.emin <= stored_format.emin &&
                              format.emax >= stored_format.emax;
    const auto& [flake, mesh, inputs] = primitives.flake_and_mesh();
    return {std::move(listed), {flake, mesh, inputs}, holds_stored ? std::nullopt : std::optional(format)};
}

}  // namespace

SphereColumns::SphereColumns(const sphere::Sphereflake& flake, file::InputRounding inputs) {
    if (inputs == file::InputRounding::shared) columns_ = make_sphere_columns<float>(flake, binary32);
    else columns_ = make_sphere_columns<double>(flake, binary64);
}

StoredMesh::StoredMesh(std::shared_ptr<const triangle::Mesh> mesh, std::optional<Transform<double>> transform,
                       file::InputRounding inputs)
    : mesh_(std::move(mesh)), vertices_(mesh_->vertices), transform_(std::move(transform)) {
    if (inputs == file::InputRounding::own) return;
    const auto stored = [](double x) { return rounding::to_format(x, 0, binary32); };
    for (Vec<double>& v : vertices_)
        for (int k = 0; k < 3; ++k) v[k] = stored(v[k]);
    if (transform_) transform_ = convert_numbers(*transform_, stored);
}

void StoredMesh::prefetch(std::span<const std::uint32_t> triangles, std::size_t first) const {
    for (const std::uint32_t i : triangles)
        if (i >= first) __builtin_prefetch(&mesh_->faces[i - first]);
    for (const std::uint32_t i : triangles) {
        if (i < first) continue;
        for (const std::uint32_t corner : mesh_->faces[i - first]) __builtin_prefetch(&vertices_[corner]);
    }
}

std::vector<Primitive<double>> round_listed_primitives(const file::Scene& scene) {
    std::vector<Primitive<double>> listed;
    for (const Primitive<Real>& primitive : scene.listed) listed.push_back(round_primitive(primitive, binary32));
    return listed;
}

std::shared_ptr<const StoredMesh> make_shared_mesh(const file::Scene& scene) {
    return scene.mesh
               ? std::make_shared<const StoredMesh>(scene.mesh, scene.mesh_transform, file::InputRounding::shared)
               : nullptr;
}

PrimitiveList<double> make_shared_primitive_list(const file::Scene& scene) {
    return make_list_with_flake_and_mesh(round_listed_primitives(scene), scene);
}

PrimitiveList<double> primitive_list_of(const RayGroup& group) {
    const bool is_wide = group.mesh && !fits_binary32(*group.mesh);
    return {
        group.primitives,
        {.flake = {}, .mesh = group.mesh, .inputs = is_wide ? file::InputRounding::own : file::InputRounding::shared}};
}

PrimitiveList<Real> make_ideal_primitive_list(const file::Scene& scene) {
    return make_list_with_flake_and_mesh(scene.listed, scene);
}

PrimitiveList<double> round_primitives(const PrimitiveList<double>& primitives, const FloatFormat& format) {
    return round_list(primitives, format);
}
PrimitiveList<double> round_primitives(const PrimitiveList<Real>& primitives, const FloatFormat& format) {
    return round_list(primitives, format);
}

}  // namespace lostbits::scene::rays
