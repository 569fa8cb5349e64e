#include "measure/choose/margin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "measure/choose/candidates.hpp"
#include "measure/choose/file_rays.hpp"
#include "measure/choose/ideal_rays.hpp"
#include "measure/study/study.hpp"
#include "measure/truth/band.hpp"
#include "number/real.hpp"
#include "scene/file/stretch.hpp"

namespace lostbits::measure::choose {

using scene::file::Camera;
using scene::file::Scene;

namespace {

double double_of(const Real& x) { return static_cast<double>(x); }

StretchedScene stretch_offset(const Scene& scene, const Real& k) {
    const Vec<Real> direction = scene::file::offset_direction();
    const Real distance = (k - 1) * length(scene::file::middle_of(scene) - scene.camera.eye);
    return {scene::file::translate(scene, (distance / length(direction)) * direction), double_of(distance)};
}

std::optional<StretchedScene> stretch_distance(const Scene& scene, const Real& k) {
    auto farther_scene = scene::file::move_farther(scene, k);
    if (!farther_scene) return std::nullopt;
    const Real distance = scene::file::view_fraction(scene) * length(scene.camera.look_at - scene.camera.eye);
    return StretchedScene{std::move(*farther_scene), double_of(k * distance)};
}

std::optional<StretchedScene> stretch_radius(const Scene& scene, const Real& k) {
    auto larger_scene = scene::file::grow(scene, k);
    if (!larger_scene) return std::nullopt;
    Real largest(0);
    for (const Primitive<Real>& primitive : larger_scene->primitives())
        largest = std::max(largest, scene::file::size_of(primitive));
    return StretchedScene{std::move(*larger_scene), double_of(largest)};
}

std::optional<StretchedScene> stretch_view(Scene scene, const Real& k) {
    if (scene.camera.kind != Camera::Kind::pinhole) return std::nullopt;
    scene.camera.fov_deg = scene::file::degrees_of(k * scene::file::half_tangent(scene.camera.fov_deg));
    const double degrees = double_of(scene.camera.fov_deg);
    if (degrees > 170) return std::nullopt;
    return StretchedScene{std::move(scene), degrees};
}

}  // namespace

std::optional<StretchedScene> stretch(const Scene& scene, Growth growth, double factor) {
    const bool is_pixel_plane = scene.camera.kind == Camera::Kind::pixel_plane;
    const Real k(factor);
    switch (growth) {
        case Growth::distance: return is_pixel_plane ? std::nullopt : stretch_distance(scene, k);
        case Growth::radius: return scene.flake ? std::nullopt : stretch_radius(scene, k);
        case Growth::offset: return is_pixel_plane ? std::nullopt : std::optional(stretch_offset(scene, k));
        case Growth::view: return stretch_view(scene, k);
    }
    return std::nullopt;
}

namespace {

/// True if the stored scene is still the ideal one: for nine rays of ten, the decision is the same and t agrees within
/// a tenth.
bool matches_ideal_scene(const truth::Band& stored, const truth::Band& ideal) {
    const auto t_of = [](const truth::Band& band, std::size_t i) {
        return band.truth(i, {}).is_hit() ? band.rounded_truth(i, binary64, intersect::Direction::any, {}) : HUGE_VAL;
    };
    std::size_t mismatch_count = 0;
    for (std::size_t i = 0; i < ideal.pixel_count(); ++i) {
        const double stored_t = t_of(stored, i), ideal_t = t_of(ideal, i);
        mismatch_count += stored_t != ideal_t && !(std::fabs(stored_t - ideal_t) <= 0.1 * ideal_t);
    }
    return 10 * mismatch_count <= ideal.pixel_count();
}

/// Result at one factor.
struct Measurement {
    double value;
    FormQuality quality;
    bool is_ideal_scene;
};
/// Measures at a factor; returns nothing if the growth does not apply there.
using MeasureAt = std::function<std::optional<Measurement>(Growth growth, double factor)>;

/// Search along one kind of growth.
class Search {
public:
    Search(const MeasureAt& measure_at, const Requirement& requirement, Growth growth)
        : measure_at_(measure_at), requirement_(requirement) {
        margin_.growth = growth;
    }

    /// Returns nothing if the growth does not apply.
    std::optional<GrowthMargin> run() {
        // The step is not 2, because doubled numbers keep their significands, and so the rounding errors that all rays
        // share, which may happen to be small. On a sphere of radius 6371000, sphere.pythagoras kept 16 bits in f64 at
        // 2^15 times the radius, and 15.3 at 31392 times.
        constexpr double largest_factor = 0x1p64, fine_ratio = 1.02, growth_step = 1.8392867552141612;
        double factor = 1;
        while (factor <= largest_factor && try_at(factor)) factor *= growth_step;
        if (!is_measured_) return std::nullopt;
        if (margin_.end == MarginEnd::none || margin_.holding_factor == 0) return margin_;
        while (margin_.end_factor / margin_.holding_factor > fine_ratio)
            try_at(std::sqrt(margin_.holding_factor * margin_.end_factor));
        return margin_;
    }

private:
    /// True if the requirement is met at that factor; records the result.
    bool try_at(double factor) {
        const auto measurement = measure_at_(margin_.growth, factor);
        if (!measurement) return false;
        is_measured_ = true;
        const FormQuality& quality = measurement->quality;
        const bool meets =
            quality.meets(requirement_) || (quality.true_hit_count == 0 && quality.decides_as_required(requirement_));
        const MarginEnd end = !measurement->is_ideal_scene  ? MarginEnd::other_scene
                              : !meets                      ? MarginEnd::fails
                              : quality.true_hit_count == 0 ? MarginEnd::nothing_hit
                                                            : MarginEnd::none;
        if (end == MarginEnd::none) {
            margin_.holding_factor = factor;
            margin_.value = measurement->value;
            return true;
        }
        margin_.end = end;
        margin_.end_factor = factor;
        margin_.end_quality = end == MarginEnd::fails ? quality : FormQuality{};
        return false;
    }

    const MeasureAt& measure_at_;
    const Requirement& requirement_;
    bool is_measured_ = false;
    GrowthMargin margin_{};
};

std::optional<Measurement> measure_scene(const ChoiceRequest& request, const evaluate::TestedForm& tested_form,
                                         const Scene& small_scene, Growth growth, double factor) {
    const auto larger_scene = stretch(small_scene, growth, factor);
    if (!larger_scene) return std::nullopt;

    const Scene& scene = larger_scene->scene;
    culling::Culler culler(scene);
    const truth::Band band(scene, 0, scene.height, request.limit, &culler);
    const FormQuality quality = measure_quality_on(band, tested_form, request.requirement);
    request.progress(band.pixel_count());

    if (scene.inputs == scene::file::InputRounding::own) return Measurement{larger_scene->value, quality, true};

    // Shared inputs were rounded, and a large growth may make another scene of them.
    Scene ideal = scene;
    ideal.inputs = scene::file::InputRounding::own;
    culling::Culler ideal_culler(ideal);
    const truth::Band ideal_band(ideal, 0, ideal.height, request.limit, &ideal_culler);
    return Measurement{larger_scene->value, quality, matches_ideal_scene(band, ideal_band)};
}

std::optional<Measurement> measure_rays(const ChoiceRequest& request, const evaluate::TestedForm& tested_form,
                                        const IdealRays& rays, Growth growth, double factor) {
    const auto stretched_rays = stretch(rays, growth, factor);
    if (!stretched_rays) return std::nullopt;
    const truth::Band band(store_in_format(stretched_rays->rays, request.rays->format.parameters), request.limit);
    const FormQuality quality = measure_quality_on(band, tested_form, request.requirement);
    request.progress(band.pixel_count());
    return Measurement{stretched_rays->value, quality,
                       matches_ideal_scene(band, stretched_rays->rays.band(request.limit))};
}

}  // namespace

std::vector<GrowthMargin> find_margins(const ChoiceRequest& request, const evaluate::TestedForm& tested_form,
                                       int pixels) {
    MeasureAt measure_at;
    if (request.scene) {
        // Far away, rounding makes every triangle of a mesh a possible hit, so each ray is tested against each
        // triangle.
        constexpr std::size_t max_pairs = 1 << 24;
        const std::size_t face_count = request.scene->mesh ? request.scene->mesh->faces.size() : 1;
        const int max_pixels = std::min(pixels, static_cast<int>(std::max<std::size_t>(max_pairs / face_count, 64)));
        measure_at = [&, small_scene = with_smaller_picture(*request.scene, max_pixels)](Growth growth, double factor) {
            return measure_scene(request, tested_form, small_scene, growth, factor);
        };
    } else {
        measure_at = [&, rays = make_ideal_rays(request.rays->sample)](Growth growth, double factor) {
            return measure_rays(request, tested_form, rays, growth, factor);
        };
    }

    std::vector<GrowthMargin> margins;
    for (const Growth growth : growths) {
        if (const auto margin = Search(measure_at, request.requirement, growth).run()) margins.push_back(*margin);
    }
    return margins;
}

std::optional<SafeOffsets> find_safe_offsets(const scene::file::Scene& scene, const evaluate::TestedForm& tested_form,
                                             truth::ProofLimit limit, int pixels) {
    constexpr std::size_t max_tests = 1 << 16;
    constexpr std::size_t max_near_triangles = 64;  // each point is tested against at most this many
    const std::size_t face_count = scene.mesh ? scene.mesh->faces.size() : 0,
                      other_primitives = scene.primitive_count() - face_count;
    if (other_primitives + face_count == 0 || other_primitives > offset::max_primitives ||
        !offset::can_measure_offsets(*tested_form.form))
        return std::nullopt;

    // Measures as many pixels as the tests of their points allow.
    const std::size_t tests_per_point = other_primitives + std::min(face_count, max_near_triangles);
    const auto affordable_pixels = static_cast<int>(std::clamp<std::size_t>(max_tests / tests_per_point, 64, 65536));
    const scene::file::Scene small_scene = with_smaller_picture(scene, std::min(pixels, affordable_pixels));
    const offset::OffsetStudy offset_study{.scene = small_scene,
                                           .tested_forms = {{tested_form}},
                                           .strategies = offset::all_strategies(),
                                           .limit = limit,
                                           .search_quiet_offset = false};
    const offset::OffsetSummary summary = std::move(study::run_study(offset_study).front());

    SafeOffsets safe;
    safe.point_count = summary.points;
    for (const offset::Side side : offset::both_sides) safe.ray_count += summary.side_summary(side).ray_count;
    safe.outside = offset::find_safe_strategies(summary, offset_study.strategies, tested_form.form->shape,
                                                std::array{offset::Side::outside});
    safe.both_sides = offset::find_safe_strategies(summary, offset_study.strategies, tested_form.form->shape);
    return safe;
}

}  // namespace lostbits::measure::choose
