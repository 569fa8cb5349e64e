#include "measure/sweep/axis_columns.hpp"

#include <cmath>

#include "intersect/simd/packed_many.hpp"
#include "measure/truth/unit_direction.hpp"

namespace lostbits::measure::sweep {

using evaluate::TestedForm;
using intersect::Direction;
using intersect::table::HitBatch;
using intersect::table::RayBatch;

namespace {

Vec<float> unit(const Vec<float>& direction) {
    const Vec<double> d = truth::unit_direction(Vec<double>(direction.x, direction.y, direction.z), binary32);
    return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
}

std::span<const float> one(const float& x) { return {&x, 1}; }

}  // namespace

AxisColumns::AxisColumns(const scene::sweep::ExhaustiveFile& file, std::size_t ray, std::size_t most)
    : file_(file), ray_(ray), near_(most), far_(most) {
    const Ray<float>& r = file.rays[ray].ray;
    ray_numbers_ = {r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z};
    solid_numbers_ = file.solid.numbers;
    for (const std::size_t place : file.ray_places) ray_varies_[place] = true;
    for (const std::size_t place : file.solid_places) solid_varies_[place] = true;
    direction_varies_ = ray_varies_[3] || ray_varies_[4] || ray_varies_[5];
    for (std::size_t k = 0; k < ray_columns_.size(); ++k)
        if (!ray_varies_[k]) ray_columns_[k].assign(most, ray_numbers_[k]);
    for (std::size_t k = 0; k < solid_columns_.size() && !file.solid_places.empty(); ++k)
        if (!solid_varies_[k]) solid_columns_[k].assign(most, solid_numbers_[k]);
    if (std::isfinite(file.rays[ray].tmax)) tmax_.assign(most, file.rays[ray].tmax);
}

void AxisColumns::set(std::span<const float> values) {
    values_ = values;
    if (direction_varies_) units_made_ = false;
}

truth::ProblemColumns<float> AxisColumns::problems() const { return problems(values_); }

truth::ProblemColumns<float> AxisColumns::problems(std::span<const float> values) const {
    truth::ProblemColumns<float> p{.size = values.size(), .ray = {}, .shape = file_.solid.shape, .solid = {}};
    for (std::size_t k = 0; k < 6; ++k) p.ray[k] = ray_varies_[k] ? values : one(ray_numbers_[k]);
    for (std::size_t k = 0; k < file_.solid.used().size(); ++k)
        p.solid[k] = solid_varies_[k] ? values : one(solid_numbers_[k]);
    if (!tmax_.empty()) p.tmax = one(tmax_.front());
    return p;
}

truth::Truth AxisColumns::find_truth(std::size_t i, const truth::ColumnTerms& terms) const {
    const scene::rays::RayGroup group = file_.group_at(ray_, values_[i]);
    return truth::find_truth(group.rays[0], group.solids[0], terms.limit, terms.convention, group.rays.range(0));
}

/// The directions that forms for unit length receive, as maps give them.
void AxisColumns::make_unit_directions() {
    if (units_made_) return;
    units_made_ = true;
    const std::size_t room = near_.size(), count = direction_varies_ ? values_.size() : room;
    for (auto& column : unit_columns_) column.resize(room);
    Vec<float> d{};
    for (std::size_t i = 0; i < count; ++i) {
        if (i == 0 || direction_varies_) d = unit(file_.ray_at(ray_, direction_varies_ ? values_[i] : 0.0F).direction);
        for (int k = 0; k < 3; ++k) unit_columns_[static_cast<std::size_t>(k)][i] = d[k];
    }
}

std::span<const float> AxisColumns::wide(std::size_t place, bool unit) const {
    if (unit && place >= 3) return std::span<const float>(unit_columns_[place - 3]).first(values_.size());
    return ray_varies_[place] ? values_ : std::span<const float>(ray_columns_[place]).first(values_.size());
}

Ray<float> AxisColumns::ray_for(const TestedForm& row, std::size_t i) const {
    Ray<float> ray = file_.ray_at(ray_, values_[i]);
    if (row.form->info->direction == Direction::unit)
        ray.direction = {unit_columns_[0][i], unit_columns_[1][i], unit_columns_[2][i]};
    return ray;
}

void AxisColumns::answer(const TestedForm& row, std::span<float> t, std::span<std::uint8_t> hit) {
    const bool unit = row.form->info->direction == Direction::unit;
    if (unit) make_unit_directions();
    if (!file_.solid_places.empty()) return answer_solids(row, t, hit);
    const std::size_t n = values_.size();
    const std::span<const float> tmax = tmax_.empty() ? tmax_ : std::span<const float>(tmax_).first(n);
    const RayBatch<float> batch{.ox = wide(0, unit),
                                .oy = wide(1, unit),
                                .oz = wide(2, unit),
                                .dx = wide(3, unit),
                                .dy = wide(4, unit),
                                .dz = wide(5, unit),
                                .tmax = tmax};
    intersect::simd::packed_kernels(*row.form).f32(
        batch, intersect::Target<float>(file_.solid),
        HitBatch<float>{t, std::span(near_).first(n), std::span(far_).first(n), hit});
}

/// One ray against many solids has a kernel of packs with the same bits. One that is told where the ray ends does not
/// tell a miss from a hit there.
void AxisColumns::answer_solids(const TestedForm& row, std::span<float> t, std::span<std::uint8_t> hit) {
    const intersect::simd::ManyRow many = intersect::simd::many_kernels(*row.form);
    if (!many.f32 || many.told_end || !file_.ray_places.empty()) return answer_one_by_one(row, t, hit);
    intersect::simd::SolidArrays<float> solids;
    for (std::size_t k = 0; k < file_.solid.used().size(); ++k)
        solids.numbers[k] =
            solid_varies_[k] ? values_ : std::span<const float>(solid_columns_[k]).first(values_.size());
    many.f32(ray_for(row, 0), solids, t, hit);
}

void AxisColumns::answer_one_by_one(const TestedForm& row, std::span<float> t, std::span<std::uint8_t> hit) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
        const Ray<float> ray = ray_for(row, i);
        const Solid<float> solid = file_.solid_at(values_[i]);
        const Vec<float>&o = ray.origin, &d = ray.direction;
        row.form->native32(
            RayBatch<float>{.ox = one(o.x),
                            .oy = one(o.y),
                            .oz = one(o.z),
                            .dx = one(d.x),
                            .dy = one(d.y),
                            .dz = one(d.z),
                            .tmax = tmax_.empty() ? std::span<const float>{} : one(tmax_.front())},
            intersect::Target<float>(solid),
            HitBatch<float>{t.subspan(i, 1), std::span(near_).first(1), std::span(far_).first(1), hit.subspan(i, 1)});
    }
}

}  // namespace lostbits::measure::sweep
