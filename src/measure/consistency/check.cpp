#include "measure/consistency/check.hpp"

#include <algorithm>
#include <numeric>

#include "measure/offset/offsets.hpp"

namespace lostbits::measure::consistency {

using intersect::table::Intersector;
using scene::file::Scene;

namespace {

/// Returns the tree over the triangles of a large mesh; null for scenes whose primitives are all tested.
std::shared_ptr<const culling::PrimitiveIndex> find_tree(const truth::Band& band, const FloatFormat& format,
                                                         const scene::rays::PrimitiveList<double>& primitives) {
    if (primitives.size() <= offset::max_primitives || !primitives.mesh() || !band.culler()) return nullptr;
    return band.culler()->index_for_stored_truth(format, primitives);
}

}  // namespace

FormOnBand::FormOnBand(const Scene& tested_scene, const evaluate::TestedForm& form_to_test,
                       const truth::Band& tested_band)
    : scene(tested_scene),
      tested_form(form_to_test),
      band(tested_band),
      kernels(*tested_form.form, tested_form.format, tested_band.stop()),
      inputs(tested_band.inputs_for(tested_form.format, *tested_form.form->info)),
      closest_hits(answer::evaluate(*tested_form.form, inputs)),
      tree_(find_tree(tested_band, tested_form.format.parameters, inputs.primitives)) {}

scene::rays::RayGroup FormOnBand::group_to_explain(const Ray<double>& ray, double tmax) const {
    scene::rays::RayGroup group = scene::rays::make_group(ray);
    const bool has_few = inputs.primitives.size() <= truth::Band::max_original_primitives;
    std::vector<Primitive<double>> primitives;
    if (has_few || inputs.primitives.mesh() == nullptr) primitives = inputs.primitives.all();
    if (!primitives.empty() && std::ranges::all_of(primitives, takes_tmax, &Primitive<double>::shape))
        group.rays.tmax = {tmax};
    if (has_few) group.primitives = primitives;
    return group;
}

FormOnBand::Candidates FormOnBand::candidates(std::span<const Ray<double>> rays) const {
    Candidates found;
    if (tree_) {
        std::vector<std::uint32_t> ray_candidates;
        for (const Ray<double>& ray : rays) {
            tree_->find_candidates(ray, ray_candidates);
            found.indices.insert(found.indices.end(), ray_candidates.begin(), ray_candidates.end());
        }
        std::ranges::sort(found.indices);
        found.indices.erase(std::ranges::unique(found.indices).begin(), found.indices.end());
    } else {
        found.indices.resize(inputs.primitives.size());
        std::iota(found.indices.begin(), found.indices.end(), 0U);
    }
    for (const std::uint32_t k : found.indices) found.primitives.push_back(inputs.primitives[k]);
    return found;
}

FormOnBand::RaysOfPrimitives::RaysOfPrimitives(const FormOnBand& band_form, const scene::rays::RayBlock& all_rays)
    : band_form_(band_form), all_rays_(all_rays) {
    if (!band_form.tree_) {
        ray_indices_.resize(all_rays.size());
        std::iota(ray_indices_.begin(), ray_indices_.end(), std::size_t{0});
        return;
    }
    std::vector<std::pair<std::uint32_t, std::size_t>> pairs;
    std::vector<std::uint32_t> candidates;
    for (std::size_t i = 0; i < all_rays.size(); ++i) {
        band_form.kernels.stop.check();
        band_form.tree_->find_candidates(all_rays[i], candidates);
        for (const std::uint32_t k : candidates) pairs.emplace_back(k, i);
    }
    std::ranges::sort(pairs);
    for (const auto& [primitive, ray] : pairs) {
        if (primitives_.empty() || primitives_.back() != primitive) runs_.emplace_back(ray_indices_.size(), 0);
        primitives_.push_back(primitive);
        ray_indices_.push_back(ray);
        runs_.back().second = ray_indices_.size();
    }
}

scene::rays::RayBlock FormOnBand::RaysOfPrimitives::rays_at(std::span<const std::size_t> ray_indices) const {
    scene::rays::RayBlock rays;
    for (const std::size_t i : ray_indices) {
        rays.push(all_rays_[i]);
        rays.push_range(all_rays_, i);
    }
    rays.mark_as_list();
    return rays;
}

namespace {

bool always_applies(const Scene&, const Intersector&) { return true; }
bool applies_if_t_reported(const Scene&, const Intersector& form) { return returns_t(*form.info); }
/// A form that assumes unit directions cannot take the direction q − p.
bool applies_to_any_length(const Scene&, const Intersector& form) {
    return returns_t(*form.info) && form.info->direction == intersect::Direction::any;
}
/// A reversed segment meets a surface from the other side.
bool applies_to_both_sides(const Scene&, const Intersector& form) {
    return form.info->facing == intersect::Facing::both;
}
bool applies_with_light(const Scene& scene, const Intersector& form) {
    return scene.appearance.light.has_value() && applies_to_any_length(scene, form);
}

constexpr Check check_rows[] = {
    {"beyond", "a shadow test that ends one number after the closest hit finds a hit", "the closest hit at t",
     "any hit of a ray that ends at the number after t", applies_if_t_reported, check_beyond},
    {"end", "a hit at the very end of a shadow test: the form keeps to its convention",
     "a hit before t, by the closest hit (no: the closest hit is at t)", "any hit of a ray that ends at t",
     applies_if_t_reported, check_end},
    {"before", "a shadow test that ends one number before the closest hit finds nothing",
     "a hit before t, by the closest hit (no: the closest hit is at t)",
     "any hit of a ray that ends at the number before t", applies_if_t_reported, check_before},
    {"segment", "the segment from the origin p to the point q seen there, written in two ways",
     "direction q - p, up to t = 1", "direction (q - p)/|q - p|, up to t = |q - p|", applies_to_any_length,
     check_segment},
    {"short", "the same segments, cut at 1 - 1e-4 of the way", "direction q - p, up to t = 1 - 1e-4",
     "direction (q - p)/|q - p|, up to t = |q - p| (1 - 1e-4)", applies_to_any_length, check_short},
    {"light", "the segment from the light p to the point q seen, up to 1 - 1e-4 of the way",
     "direction q - p, up to t = 1 - 1e-4", "direction (q - p)/|q - p|, up to t = |q - p| (1 - 1e-4)",
     applies_with_light, check_light},
    {"packs", "rays one by one and in batches, at every register width: bit by bit", "rays one by one", "rays together",
     always_applies, check_packs},
    {"reverse", "one segment from either end: one decision, and near and far sides that add up to its length",
     "from p to q", "from q to p", applies_to_both_sides, check_reverse, true},
    {"placed", "one primitive with and without a matrix: one decision, and t within an ulp",
     "each primitive as the scene has it", "the same primitive without its matrix, or under one if it has none",
     always_applies, check_placed, true},
};

}  // namespace

std::span<const Check> checks() { return check_rows; }

std::vector<const Check*> all_checks() {
    std::vector<const Check*> all;
    for (const Check& c : check_rows) all.push_back(&c);
    return all;
}

}  // namespace lostbits::measure::consistency
