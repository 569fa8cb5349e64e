#include "measure/answer/one_ray.hpp"

#include <algorithm>

#include "number/error.hpp"

namespace lostbits::measure::answer {

using scene::file::Scene;
using truth::Band;

OneRay::OneRay(const Scene& scene, int x, int y, truth::ProofLimit limit) {
    if (x < 0 || y < 0 || x >= scene.width || y >= scene.height) {
        throw InputError("--pixel " + std::to_string(x) + "," + std::to_string(y) + ": scene " + scene.id +
                         " has columns 0 to " + std::to_string(scene.width - 1) + " and rows 0 to " +
                         std::to_string(scene.height - 1));
    }
    if (scene.inputs == scene::file::InputRounding::shared) {
        // The ray gets a band of its own. In a band with the other rays of its row, it would be tested against many
        // more spheres.
        const scene::rays::RayBlock row = scene::rays::make_shared_rays(scene, y, y + 1);
        const auto column = static_cast<std::size_t>(x);
        scene::rays::RayBlock single_ray = scene::rays::make_group(row[column]).rays;
        single_ray.push_range(row, column);
        make_band(scene, std::move(single_ray), limit);
        return;
    }
    band_ = std::make_unique<Band>(scene, y, y + 1, limit);
    index_ = static_cast<std::size_t>(x);
}

OneRay::OneRay(const Scene& scene, const Ray<Real>& ray, truth::ProofLimit limit) {
    scene::rays::IdealRayBlock single_ray;
    single_ray.push(ray);
    single_ray.mark_as_list();
    scene::rays::set_range(scene, single_ray);
    if (scene.inputs == scene::file::InputRounding::own)
        band_ = std::make_unique<Band>(scene, std::move(single_ray), limit);
    else make_band(scene, scene::rays::round_rays(single_ray, binary64), limit);
}

void OneRay::make_band(const Scene& scene, scene::rays::RayBlock ray, truth::ProofLimit limit) {
    culler_ = std::make_unique<culling::Culler>(scene, ray[0]);
    band_ = std::make_unique<Band>(scene, std::move(ray), *culler_, limit);
}

OneRay::OneRay(scene::rays::RayGroup group) : band_(std::make_unique<Band>(std::move(group))) {}

std::vector<OneRay> OneRay::make_pixels_around(const Scene& scene, int x, int y, truth::ProofLimit limit) {
    std::vector<OneRay> rays;
    for (const int row : {y, y - 1, y + 1}) {
        if (row < 0 || row >= scene.height) continue;
        const auto band = std::make_shared<Band>(scene, row, row + 1, limit);
        if (row == y) rays.push_back(OneRay(band, static_cast<std::size_t>(x)));
        const int first = std::max(0, x - columns_around), last = std::min(scene.width - 1, x + columns_around);
        for (int column = first; column <= last; ++column)
            if (row != y || column != x) rays.push_back(OneRay(band, static_cast<std::size_t>(column)));
    }
    return rays;
}

OneRay::Inputs OneRay::inputs(const intersect::table::Intersector& form, const Format& format) const {
    return {band_->inputs_for(format, *form.info), index_};
}

double OneRay::condition(const intersect::Info& info) const {
    band_->find_condition();
    return band_->condition(index_, convention(info));
}

double OneRay::reach(const intersect::Info& info, const Format& format) const {
    return band_->reach(index_, convention(info), info.direction, {.format = format});
}

truth::CertifiedNumber OneRay::true_t(const intersect::Info& info) const {
    const truth::Truth ray_truth = find_truth(info);
    return info.direction == intersect::Direction::unit ? ray_truth.distance : ray_truth.t;
}

intersect::table::MarchLog record_march(const intersect::table::Intersector& form, const Format& format,
                                        const OneRay& ray) {
    const OneRay::Inputs in = ray.inputs(form, format);
    return form.log(format, in.ray(*form.info), in.format_inputs.target_for(form, 0));
}

}  // namespace lostbits::measure::answer
