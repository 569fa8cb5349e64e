#include "measure/offset/offsets.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "intersect/process/parallel.hpp"
#include "measure/answer/answers.hpp"
#include "measure/answer/owners.hpp"
#include "measure/render/stored_appearance.hpp"
#include "number/error.hpp"

namespace lostbits::measure::offset {

using scene::file::Scene;
using truth::Band;
using truth::Truth;

namespace {

/// Measures one row on one band.
class OffsetMeasurement {
public:
    OffsetMeasurement(const OffsetStudy& study, const OffsetForm& offset_form, const Band& band)
        : study_(study),
          row_(offset_form),
          inputs_(band.inputs_for(offset_form.tested_form.format, *offset_form.tested_form.form->info)),
          answers_(answer::evaluate(*offset_form.tested_form.form, inputs_)),
          tree_(tree_of(band, offset_form.tested_form.format.parameters, inputs_.primitives)),
          work_(row_.tested_form, row_.point_kind, inputs_.primitives, tree_.get(), light(), study.strategies),
          band_(band) {
        const std::size_t pixel_count = band.pixel_count(), strategy_count = study.strategies.size();

        // Nothing is a point yet.
        result_.y0 = band.y0();
        result_.scanlines = band.scanlines();
        result_.width = study.scene.width;
        result_.strategy_count = strategy_count;
        result_.is_point.assign(pixel_count, 0);
        result_.primitive.assign(pixel_count, -1);
        result_.ulp.assign(pixel_count, truth::missing);
        result_.sides.resize(pixel_count);
        result_.by_strategy.resize(2 * pixel_count * strategy_count);
    }

    void measure() {
        const std::size_t strategy_count = result_.strategy_count;
        intersect::process::in_parallel(
            tbb::blocked_range<std::size_t>(0, band_.pixel_count(), 16), [&](const auto& range) {
                for (std::size_t i = range.begin(); i < range.end(); ++i) {
                    study_.limit.stop.check();
                    if (!hits_true_primitive(i)) continue;
                    const auto by_strategy =
                        std::span(result_.by_strategy).subspan(2 * i * strategy_count, 2 * strategy_count);
                    if (!work_.measure(form_hit(i), result_.sides[i], by_strategy, study_.search_quiet_offset))
                        continue;
                    result_.is_point[i] = 1;
                    result_.primitive[i] = answers_.primitive[i];
                    result_.ulp[i] = ulp_of(work_.hit_point(form_hit(i))->p);
                }
            });
    }

    void add_to(OffsetSummary& summary) const {
        summary.pixels += result_.is_point.size();
        for (std::size_t i = 0; i < result_.is_point.size(); ++i) {
            if (band_.truth(i, row_.tested_form.convention()).decision == Truth::Decision::unresolved)
                ++summary.unresolved;
            if (result_.is_point[i] == 0) continue;
            ++summary.points;
            for (const Side side : both_sides) add_side(i, side, summary.sides[static_cast<std::size_t>(side)]);
        }
    }

    [[nodiscard]] OffsetBand take_result() { return std::move(result_); }

private:
    /// Returns the tree over the primitives in the format; null if there are few primitives, or only spheres.
    static std::shared_ptr<const culling::BoxTree> tree_of(const Band& band, const FloatFormat& format,
                                                           const scene::rays::PrimitiveList<double>& primitives) {
        const auto index = band.culler() ? band.culler()->index_for_stored_truth(format, primitives) : nullptr;
        return std::dynamic_pointer_cast<const culling::BoxTree>(index);
    }
    [[nodiscard]] std::optional<Vec<double>> light() const {
        if (!study_.scene.appearance.light) return std::nullopt;
        return render::make_input_appearance(study_.scene, row_.tested_form.format.parameters).light;
    }
    [[nodiscard]] bool hits_true_primitive(std::size_t i) const {
        if (answers_.hit[i] == 0 || !(answers_.t[i] > 0)) return false;
        return answer::meets_first(band_, i, answers_.primitive[i], row_.tested_form.convention());
    }
    [[nodiscard]] FormHit form_hit(std::size_t i) const {
        return {inputs_.rays_for(*row_.tested_form.form->info)[i], answers_.t[i],
                static_cast<std::size_t>(answers_.primitive[i])};
    }
    [[nodiscard]] double ulp_of(const Vec<double>& p) const {
        const double size = largest_of(p);
        const long binade = size > 0 ? std::ilogb(size) : std::numeric_limits<int>::min();
        return std::ldexp(1.0, static_cast<int>(ulp_exponent(row_.tested_form.format.parameters, binade)));
    }

    void add_side(std::size_t i, Side side, SideSummary& summary) const {
        const SideOfPoint& side_result = result_.sides[i][static_cast<std::size_t>(side)];
        summary.ray_count += side_result.ray_count;
        summary.already_safe_point_count += static_cast<std::uint64_t>(side_result.safe_offset == 0);
        summary.never_safe_point_count += static_cast<std::uint64_t>(std::isinf(side_result.safe_offset));
        summary.never_quiet_point_count += static_cast<std::uint64_t>(std::isinf(side_result.quiet_offset));
        if (std::isfinite(side_result.safe_offset)) {
            summary.safe_offset.add(side_result.safe_offset);
            summary.safe_ulps.add(side_result.safe_offset / result_.ulp[i]);
        }
        if (std::isfinite(side_result.quiet_offset)) summary.quiet_offset.add(side_result.quiet_offset);
        for (std::size_t k = 0; k < result_.strategy_count; ++k) add_strategy(i, side, k, summary);
    }

    /// Adds the results of strategy k at pixel i, and keeps the first ray with each fault.
    void add_strategy(std::size_t i, Side side, std::size_t k, SideSummary& summary) const {
        const double safe_offset = result_.sides[i][static_cast<std::size_t>(side)].safe_offset;
        const StrategyAtPoint& strategy_result = result_.at(i, side, k);
        StrategySummary& s = summary.strategies[k];
        s.offset_size.add(strategy_result.offset_size);
        if (std::isfinite(safe_offset) && safe_offset > 0) {
            s.size_ratio.add(strategy_result.offset_size / safe_offset);
            s.too_small_point_count += static_cast<std::uint64_t>(strategy_result.offset_size < safe_offset);
        }

        bool has_new_fault = false, has_fault = false;
        for (std::size_t f = 0; f < fault_names.size(); ++f) {
            s.fault_counts[f] += strategy_result.fault_counts[f];
            has_fault = has_fault || strategy_result.fault_counts[f] > 0;
            has_new_fault = has_new_fault || (strategy_result.fault_counts[f] > 0 && !s.first_faulty_rays[f]);
        }
        if (has_fault) s.bad_ray_count += strategy_result.bad_ray_count;
        if (has_new_fault) keep_first_bad_rays(i, side, k, s);
    }

    /// Makes the rays of strategy k at pixel i once more, and keeps those that are the first with a fault.
    void keep_first_bad_rays(std::size_t i, Side side, std::size_t k, StrategySummary& s) const {
        const auto pixel = static_cast<int>(i);
        for (const NewRay& ray : work_.rays(form_hit(i), *study_.strategies[k], side)) {
            for (std::size_t f = 0; f < fault_names.size(); ++f) {
                if (s.first_faulty_rays[f] || !ray.has(static_cast<Fault>(f))) continue;
                s.first_faulty_rays[f] =
                    FaultyRay{pixel % result_.width, result_.y0 + pixel / result_.width, answers_.primitive[i], ray,
                              inputs_.primitives[answers_.primitive[i]]};
            }
        }
    }

    const OffsetStudy& study_;
    const OffsetForm& row_;
    truth::FormatInputs inputs_;
    answer::Answers answers_;
    std::shared_ptr<const culling::BoxTree> tree_;
    PointWork work_;
    const Band& band_;
    OffsetBand result_;
};

}  // namespace

void require_few_primitives(const Scene& scene) {
    const std::size_t primitives_outside_meshes = scene.primitive_count() - (scene.mesh ? scene.mesh->faces.size() : 0);
    if (primitives_outside_meshes <= max_primitives) return;
    throw InputError(
        fmt::format("scene {} has {} primitives besides its meshes, and every ray is tested against all of them; at "
                    "most {} are allowed; try a part of the scene",
                    scene.id, primitives_outside_meshes, max_primitives));
}

bool can_measure_offsets(const intersect::table::Intersector& form) {
    return is_primitive(form.shape) && form.info->roots != intersect::Roots::none;
}

const std::vector<std::string_view>& usual_forms() {
    // Forms that renderers use. For a shape that is not listed, the first form of the catalogue that reports t is used.
    constexpr std::array<std::string_view, 11> preferred{
        "sphere.half_b",    "box.ieee_minmax",       "triangle.moller_trumbore",
        "ellipsoid.half_b", "cylinder.framed",       "capsule.half_b",
        "tube.framed",      "cone.framed",           "disc.framed",
        "plane.quotient",   "torus.closest_approach"};
    static const std::vector<std::string_view> all_names = [&] {
        std::vector<std::string_view> names;
        for (const ShapeRow& shape : shape_rows) {
            std::string_view name;
            for (const auto& form : intersect::table::catalogue()) {
                if (form.shape != shape.shape || !can_measure_offsets(form)) continue;
                const bool is_preferred = std::ranges::find(preferred, form.info->name) != preferred.end();
                if (name.empty() || is_preferred) name = form.info->name;
            }
            if (!name.empty()) names.push_back(name);
        }
        return names;
    }();
    return all_names;
}

void OffsetStudy::require() const { require_few_primitives(scene); }

OffsetSummary OffsetStudy::begin(std::size_t) const {
    OffsetSummary summary;
    for (SideSummary& side : summary.sides) side.strategies.resize(strategies.size());
    return summary;
}

OffsetBand OffsetStudy::measure(const truth::Band& band, std::size_t form_index, OffsetSummary& summary) const {
    OffsetMeasurement measurement(*this, tested_forms[form_index], band);
    measurement.measure();
    measurement.add_to(summary);
    return measurement.take_result();
}

std::vector<SafeStrategy> find_safe_strategies(const OffsetSummary& summary,
                                               const std::vector<const Strategy*>& strategies, Shape shape,
                                               std::span<const Side> sides) {
    std::vector<SafeStrategy> safe;
    for (std::size_t k = 0; k < strategies.size() && summary.points > 0; ++k) {
        const auto has_no_bad_ray = [&](Side side) {
            return summary.side_summary(side).strategies[k].bad_ray_count == 0;
        };
        if (!std::ranges::all_of(sides, has_no_bad_ray)) continue;
        double largest_ratio = truth::missing;
        for (const Side side : sides) {
            const double median = summary.side_summary(side).strategies[k].size_ratio.quantile(0.5);
            if (!(largest_ratio >= median)) largest_ratio = median;
        }
        safe.push_back({strategies[k], strategies[k]->operation_count(shape), largest_ratio});
    }
    std::ranges::stable_sort(safe, {}, &SafeStrategy::operation_count);
    return safe;
}

}  // namespace lostbits::measure::offset
