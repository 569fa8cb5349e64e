#include "measure/evaluate/own_words.hpp"

#include <cmath>

namespace lostbits::measure::evaluate {

OwnWords::OwnWords(const TestedForm& row, unsigned needs, const truth::FormatInputs& inputs, const Ray<double>& ray,
                   std::size_t i, std::size_t solid, std::int32_t truly) {
    const intersect::table::Intersector& form = *row.form;
    const auto& rays = inputs.rays_for(*form.info);
    const double tmax = rays.tmax.empty() ? HUGE_VAL : rays.tmax[i];
    if ((needs & metric::needs_bound) && form.bounded)
        bounded_ = form.bounded(row.format, ray, inputs.target_for(form, solid), tmax);
    if ((needs & metric::needs_way) && form.way) way_ = form.way(row.format, ray, inputs.target_for(form, solid), tmax);
    if ((needs & metric::needs_levels) && truly >= 0) {
        const Solid<double> met = inputs.solids[static_cast<std::size_t>(truly)];
        const intersect::table::Intersector& part = form.of(met.shape);
        if (intersect::hull::has_box(part)) levels_ = answer::levels_of(part, row.format, ray, met, rays.range(i));
    }
    if (!(needs & (metric::needs_steps | metric::needs_end_margin))) return;
    const Solid<double> asked = inputs.solids[solid];
    const intersect::table::Intersector& part = form.of(asked.shape);
    if ((needs & metric::needs_end_margin) && intersect::hull::has_box(part))
        end_margin_ = answer::end_margin(part, row.format, ray, asked, rays.range(i));
    if (!(needs & metric::needs_steps)) return;
    if (!asked.placed || !part.is_placed) return;
    // A box in the world is no step of the way.
    steps_ = answer::steps_of(intersect::hull::within_boxes(part), row.format, ray, asked, rays.range(i));
}

void OwnWords::into(metric::Sample& sample) const {
    if (bounded_) sample.bounded = &*bounded_;
    if (way_) sample.way = &*way_;
    if (steps_) sample.steps = &*steps_;
    sample.end_margin = end_margin_;
    if (levels_) sample.levels = &*levels_;
}

}  // namespace lostbits::measure::evaluate
