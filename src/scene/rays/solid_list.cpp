#include "scene/rays/solid_list.hpp"

#include "scene/rays/rays.hpp"

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

std::shared_ptr<const SphereColumns> flake_of(const file::Scene& scene) {
    if (!scene.flake) return nullptr;
    sphere::require_room_for(*scene.flake);
    return std::make_shared<const SphereColumns>(*scene.flake, scene.inputs);
}

template <class S>
SolidList<double> rounded_list(const SolidList<S>& solids, const FloatFormat& f) {
    std::vector<Solid<double>> listed;
    for (const Solid<S>& s : solids.listed()) listed.push_back(round_solid(s, f));
    const FloatFormat& held = solids.flake() && solids.flake()->template stored<float>() ? binary32 : binary64;
    const bool holds = f.precision >= held.precision && f.emin <= held.emin && f.emax >= held.emax;
    return {std::move(listed), solids.flake(), holds ? std::nullopt : std::optional(f)};
}

}  // namespace

SphereColumns::SphereColumns(const sphere::Sphereflake& flake, file::Inputs inputs) {
    if (inputs == file::Inputs::shared) columns_ = columns_of<float>(flake, binary32);
    else columns_ = columns_of<double>(flake, binary64);
}

SolidList<double> shared_solid_list(const file::Scene& scene) {
    std::vector<Solid<double>> listed;
    for (const Solid<Real>& solid : scene.listed) listed.push_back(round_solid(solid, binary32));
    return {std::move(listed), flake_of(scene)};
}

SolidList<Real> ideal_solid_list(const file::Scene& scene) { return {scene.listed, flake_of(scene)}; }

SolidList<double> round_solids(const SolidList<double>& solids, const FloatFormat& f) {
    return rounded_list(solids, f);
}
SolidList<double> round_solids(const SolidList<Real>& solids, const FloatFormat& f) { return rounded_list(solids, f); }

}  // namespace lostbits::scene::rays
