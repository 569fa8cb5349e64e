#include "measure/choice/margin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "measure/choice/candidates.hpp"
#include "measure/choice/file_rays.hpp"
#include "measure/choice/ideal_rays.hpp"
#include "measure/study/study.hpp"
#include "measure/truth/band.hpp"
#include "number/real.hpp"
#include "scene/file/stretch.hpp"

namespace lostbits::measure::choice {

using scene::file::Camera;
using scene::file::Scene;

namespace {

double in_double(const Real& x) { return static_cast<double>(x); }

StretchedScene elsewhere(const Scene& scene, const Real& k) {
    const Vec<Real> along = scene::file::offset_direction();
    const Real away = (k - 1) * length(scene::file::middle_of(scene) - scene.camera.eye);
    return {scene::file::moved(scene, (away / length(along)) * along), in_double(away)};
}

std::optional<StretchedScene> farther_away(const Scene& scene, const Real& k) {
    auto far = scene::file::farther(scene, k);
    if (!far) return std::nullopt;
    const Real distance = scene::file::view_share(scene) * length(scene.camera.look_at - scene.camera.eye);
    return StretchedScene{std::move(*far), in_double(k * distance)};
}

std::optional<StretchedScene> larger(const Scene& scene, const Real& k) {
    auto large = scene::file::grown(scene, k);
    if (!large) return std::nullopt;
    Real largest(0);
    for (const Primitive<Real>& primitive : large->primitives())
        largest = std::max(largest, scene::file::size_of(primitive));
    return StretchedScene{std::move(*large), in_double(largest)};
}

std::optional<StretchedScene> wider(Scene scene, const Real& k) {
    if (scene.camera.kind != Camera::Kind::pinhole) return std::nullopt;
    scene.camera.fov_deg = scene::file::degrees_of(k * scene::file::half_tangent(scene.camera.fov_deg));
    const double degrees = in_double(scene.camera.fov_deg);
    if (degrees > 170) return std::nullopt;
    return StretchedScene{std::move(scene), degrees};
}

}  // namespace

std::optional<StretchedScene> stretched(const Scene& scene, Growth growth, double factor) {
    const bool plane = scene.camera.kind == Camera::Kind::pixel_plane;
    const Real k(factor);
    switch (growth) {
        case Growth::distance: return plane ? std::nullopt : farther_away(scene, k);
        case Growth::radius: return scene.flake ? std::nullopt : larger(scene, k);
        case Growth::offset: return plane ? std::nullopt : std::optional(elsewhere(scene, k));
        case Growth::view: return wider(scene, k);
    }
    return std::nullopt;
}

namespace {

/// True if the stored scene is still the ideal one: for nine rays of ten, the decision is the same and t agrees within
/// a tenth.
bool matches_ideal_scene(const truth::Band& stored, const truth::Band& meant) {
    const auto t_of = [](const truth::Band& band, std::size_t i) {
        return band.truth(i, {}).is_hit() ? band.rounded_truth(i, binary64, intersect::Direction::any, {}) : HUGE_VAL;
    };
    std::size_t other = 0;
    for (std::size_t i = 0; i < meant.pixels(); ++i) {
        const double is = t_of(stored, i), should_be = t_of(meant, i);
        other += is != should_be && !(std::fabs(is - should_be) <= 0.1 * should_be);
    }
    return 10 * other <= meant.pixels();
}

/// Result at one factor.
struct Found {
    double value;
    RowQuality quality;
    bool as_meant;
};
/// Measures at a factor; nothing if the growth does not apply there.
using Look = std::function<std::optional<Found>(Growth growth, double factor)>;

/// Search along one kind of growth.
class Search {
public:
    Search(const Look& look, const Requirement& requirement, Growth growth) : look_(look), requirement_(requirement) {
        margin_.growth = growth;
    }

    /// Nothing if the growth does not apply.
    std::optional<GrowthMargin> run() {
        // The step is not 2: doubled numbers keep their significands, and with them the luck of a rounding that all
        // rays share. On a sphere of radius 6371000, sphere.pythagoras kept 16 bits in f64 at 2^15 times the radius,
        // and 15.3 at 31392 times.
        constexpr double most = 0x1p64, close = 1.02, step = 1.8392867552141612;
        double next = 1;
        while (next <= most && try_at(next)) next *= step;
        if (!known_) return std::nullopt;
        if (margin_.end == MarginEnd::none || margin_.holds == 0) return margin_;
        while (margin_.beyond / margin_.holds > close) try_at(std::sqrt(margin_.holds * margin_.beyond));
        return margin_;
    }

private:
    /// True if the requirement is met at that factor; records the result.
    bool try_at(double factor) {
        const auto there = look_(margin_.growth, factor);
        if (!there) return false;
        known_ = true;
        const RowQuality& quality = there->quality;
        const bool meets = quality.meets(requirement_) || (quality.hits == 0 && quality.decides(requirement_));
        const MarginEnd end = !there->as_meant    ? MarginEnd::other_scene
                              : !meets            ? MarginEnd::fails
                              : quality.hits == 0 ? MarginEnd::nothing_hit
                                                  : MarginEnd::none;
        if (end == MarginEnd::none) {
            margin_.holds = factor;
            margin_.value = there->value;
            return true;
        }
        margin_.end = end;
        margin_.beyond = factor;
        margin_.broken = end == MarginEnd::fails ? quality : RowQuality{};
        return false;
    }

    const Look& look_;
    const Requirement& requirement_;
    bool known_ = false;
    GrowthMargin margin_{};
};

std::optional<Found> look_at_scene(const ChoiceRequest& request, const evaluate::TestedForm& row, const Scene& thin,
                                   Growth growth, double factor) {
    const auto there = stretched(thin, growth, factor);
    if (!there) return std::nullopt;
    const Scene& scene = there->scene;
    culling::Culler culler(scene);
    const truth::Band band(scene, 0, scene.height, request.limit, &culler);
    const RowQuality quality = quality_on(band, row, request.requirement);
    request.progress(band.pixels());
    if (scene.inputs == scene::file::Inputs::own) return Found{there->value, quality, true};
    Scene ideal = scene;
    ideal.inputs = scene::file::Inputs::own;
    culling::Culler ideal_culler(ideal);
    const truth::Band meant(ideal, 0, ideal.height, request.limit, &ideal_culler);
    return Found{there->value, quality, matches_ideal_scene(band, meant)};
}

std::optional<Found> look_at_rays(const ChoiceRequest& request, const evaluate::TestedForm& row, const IdealRays& rays,
                                  Growth growth, double factor) {
    const auto there = stretched(rays, growth, factor);
    if (!there) return std::nullopt;
    const truth::Band band(stored(there->rays, request.rays->format.parameters), request.limit);
    const RowQuality quality = quality_on(band, row, request.requirement);
    request.progress(band.pixels());
    return Found{there->value, quality, matches_ideal_scene(band, there->rays.band(request.limit))};
}

}  // namespace

std::vector<GrowthMargin> margins_of(const ChoiceRequest& request, const evaluate::TestedForm& row, int pixels) {
    Look look;
    if (request.scene) {
        // Far away, rounding reaches all triangles of a mesh: a form is asked about each of them by each ray.
        constexpr std::size_t most_pairs = 1 << 24;
        const std::size_t faces = request.scene->mesh ? request.scene->mesh->faces.size() : 1;
        const int few = std::min(pixels, static_cast<int>(std::max<std::size_t>(most_pairs / faces, 64)));
        look = [&, thin = with_smaller_picture(*request.scene, few)](Growth growth, double factor) {
            return look_at_scene(request, row, thin, growth, factor);
        };
    } else {
        look = [&, rays = ideal_of(request.rays->sample)](Growth growth, double factor) {
            return look_at_rays(request, row, rays, growth, factor);
        };
    }
    std::vector<GrowthMargin> all;
    for (const Growth growth : growths) {
        if (const auto margin = Search(look, request.requirement, growth).run()) all.push_back(*margin);
    }
    return all;
}

std::optional<SafeOffsets> safe_offsets(const scene::file::Scene& scene, const evaluate::TestedForm& row,
                                        truth::TruthLimit limit, int pixels) {
    constexpr std::size_t most_asked = 1 << 16;
    constexpr std::size_t most_near = 64;  // triangles of a mesh near a point: no more are asked
    const std::size_t faces = scene.mesh ? scene.mesh->faces.size() : 0, beside = scene.primitive_count() - faces;
    if (beside + faces == 0 || beside > offset::most_primitives || !offset::can_measure_offsets(*row.form))
        return std::nullopt;
    const std::size_t asked = beside + std::min(faces, most_near);
    const auto affordable = static_cast<int>(std::clamp<std::size_t>(most_asked / asked, 64, 65536));
    const scene::file::Scene thin = with_smaller_picture(scene, std::min(pixels, affordable));
    const offset::OffsetStudy request{
        .scene = thin, .rows = {{row}}, .strategies = offset::all_strategies(), .limit = limit, .quiet = false};
    const offset::OffsetSummary summary = std::move(study::run_study(request).front());
    SafeOffsets safe;
    safe.points = summary.points;
    for (const offset::Side side : offset::both_sides) safe.rays += summary.side_summary(side).rays;
    safe.outside =
        offset::safe_strategies(summary, request.strategies, row.form->shape, std::array{offset::Side::outside});
    safe.both = offset::safe_strategies(summary, request.strategies, row.form->shape);
    return safe;
}

}  // namespace lostbits::measure::choice
