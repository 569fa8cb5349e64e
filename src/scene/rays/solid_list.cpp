#include "scene/rays/solid_list.hpp"

#include "scene/rays/rays.hpp"
#include "scene/rays/stored_mesh.hpp"

namespace lostbits::scene::rays {
namespace {

template <class T>
std::array<std::vector<T>, 4> columns_of(const sphere::Sphereflake& flake, const FloatFormat& f) {
    std::array<std::vector<T>, 4> columns;
    for (std::vector<T>& column : columns) column.reserve(flake.size());
    sphere::for_each_solid(flake, [&](const Solid<double>& s) {
        const Solid<double> stored = round_solid(s, f);
        for (std::size_t k = 0; k < 4; ++k) columns[k].push_back(static_cast<T>(stored.numbers[k]));
    });
    return columns;
}

template <class S>
SolidList<S> with_made(std::vector<Solid<S>> listed, const file::Scene& scene) {
    typename SolidList<S>::Made made{.flake = {}, .mesh = {}, .inputs = scene.inputs};
    if (scene.flake) {
        sphere::require_room_for(*scene.flake);
        made.flake = std::make_shared<const SphereColumns>(*scene.flake, scene.inputs);
    }
    if (scene.mesh) made.mesh = std::make_shared<const MeshColumns>(scene.mesh, scene.mesh_placed, scene.inputs);
    return {std::move(listed), std::move(made)};
}

template <class S>
SolidList<double> rounded_list(const SolidList<S>& solids, const FloatFormat& f) {
    std::vector<Solid<double>> listed;
    for (const Solid<S>& s : solids.listed()) listed.push_back(round_solid(s, f));
    const FloatFormat& held = solids.made().inputs == file::Inputs::shared ? binary32 : binary64;
    const bool holds = f.precision >= held.precision && f.emin <= held.emin && f.emax >= held.emax;
    const auto& [flake, mesh, inputs] = solids.made();
    return {std::move(listed), {flake, mesh, inputs}, holds ? std::nullopt : std::optional(f)};
}

}  // namespace

SphereColumns::SphereColumns(const sphere::Sphereflake& flake, file::Inputs inputs) {
    if (inputs == file::Inputs::shared) columns_ = columns_of<float>(flake, binary32);
    else columns_ = columns_of<double>(flake, binary64);
}

MeshColumns::MeshColumns(std::shared_ptr<const triangle::Mesh> mesh, std::optional<Placement<double>> placed,
                         file::Inputs inputs)
    : mesh_(std::move(mesh)), vertices_(mesh_->vertices), placed_(std::move(placed)) {
    if (inputs == file::Inputs::own) return;
    const auto stored = [](double x) { return rounding::to_format(x, 0, binary32); };
    for (Vec<double>& v : vertices_)
        for (int k = 0; k < 3; ++k) v[k] = stored(v[k]);
    if (placed_) placed_ = transformed(*placed_, stored);
}

std::vector<Solid<double>> shared_listed(const file::Scene& scene) {
    std::vector<Solid<double>> listed;
    for (const Solid<Real>& solid : scene.listed) listed.push_back(round_solid(solid, binary32));
    return listed;
}

std::shared_ptr<const MeshColumns> shared_mesh(const file::Scene& scene) {
    return scene.mesh ? std::make_shared<const MeshColumns>(scene.mesh, scene.mesh_placed, file::Inputs::shared)
                      : nullptr;
}

SolidList<double> shared_solid_list(const file::Scene& scene) { return with_made(shared_listed(scene), scene); }

SolidList<double> solid_list_of(const RayGroup& group) {
    const bool wide = group.mesh && !fits_binary32(*group.mesh);
    return {group.solids, {.flake = {}, .mesh = group.mesh, .inputs = wide ? file::Inputs::own : file::Inputs::shared}};
}

SolidList<Real> ideal_solid_list(const file::Scene& scene) { return with_made(scene.listed, scene); }

SolidList<double> round_solids(const SolidList<double>& solids, const FloatFormat& f) {
    return rounded_list(solids, f);
}
SolidList<double> round_solids(const SolidList<Real>& solids, const FloatFormat& f) { return rounded_list(solids, f); }

}  // namespace lostbits::scene::rays
