#include "measure/map/own_words.hpp"

#include <cmath>

namespace lostbits::measure::map {

OwnWords::OwnWords(const MapRow& row, unsigned needs, const truth::FormatInputs& inputs, const Ray<double>& ray,
                   std::size_t i, std::size_t solid) {
    const intersect::table::Intersector& form = *row.form;
    const auto& rays = inputs.rays_for(*form.info);
    const double tmax = rays.tmax.empty() ? HUGE_VAL : rays.tmax[i];
    if ((needs & metric::needs_bound) && form.bounded)
        bounded_ = form.bounded(row.format, ray, inputs.target_for(form, solid), tmax);
    if ((needs & metric::needs_way) && form.way) way_ = form.way(row.format, ray, inputs.target_for(form, solid), tmax);
}

void OwnWords::into(metric::Sample& sample) const {
    if (bounded_) sample.bounded = &*bounded_;
    if (way_) sample.way = &*way_;
}

}  // namespace lostbits::measure::map
