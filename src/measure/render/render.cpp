#include "measure/render/render.hpp"

#include <algorithm>
#include <cmath>

#include "intersect/bounding_box/behind.hpp"
#include "intersect/process/parallel.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/render/blockers.hpp"
#include "measure/render/stored_appearance.hpp"
#include "measure/truth/unit_direction.hpp"
#include "number/with_number.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::render {

using evaluate::TestedForm;
using scene::file::Stage;
using truth::Band;
using truth::missing;
using truth::Truth;

namespace {

/// Calls `work.operator()<T>(i)` for every pixel. T is the number type in which the format is evaluated.
template <class Work>
void for_each_pixel_in(const Format& format, std::size_t count, intersect::process::StopToken stop, const Work& work) {
    intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& range) {
        with_number(format, [&]<class T>() {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                stop.check();
                work.template operator()<T>(i);
            }
        });
    });
}

bool is_finite(const Vec<double>& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

SeenContent content_of(const Truth& truth, bool hit, double t, std::int32_t primitive) {
    if (truth.decision == Truth::Decision::unresolved) return SeenContent::unresolved;
    if (hit && std::isnan(t)) return SeenContent::not_a_number;
    if (!truth.is_hit()) return hit ? SeenContent::extra_sphere : SeenContent::background;
    if (!hit) return SeenContent::lost_sphere;
    return primitive == truth.primitive ? SeenContent::same_sphere : SeenContent::other_sphere;
}

/// Returns the angle between n as computed (of any length) and the true unit normal N: atan2(|n × N|, n·N). The
/// products are in double-double, because the cross product of vectors 2^-53 apart cancels almost completely.
double angle_between(const Vec<double>& n, const std::array<TwoPartNumber, 3>& true_normal) {
    if (!is_finite(n)) return missing;
    const Vec<Ball> a(Ball(n.x), Ball(n.y), Ball(n.z));
    const auto ball = [](const TwoPartNumber& x) { return Ball(x.hi, x.lo, 0); };
    const Vec<Ball> b(ball(true_normal[0]), ball(true_normal[1]), ball(true_normal[2]));
    const Vec<Ball> c = cross<Ball>(a, b);
    const double across = std::sqrt(c.x.hi() * c.x.hi() + c.y.hi() * c.y.hi() + c.z.hi() * c.z.hi());
    return std::atan2(across, dot<Ball>(a, b).hi());
}

Shadow compare_shadows(TrueShadow true_shadow, std::uint8_t blocked) {
    const bool is_dark = blocked != blocked_by_nothing;
    switch (true_shadow) {
        case TrueShadow::untested: return Shadow::not_compared;
        case TrueShadow::unresolved: return Shadow::unresolved;
        case TrueShadow::lit:
            return !is_dark                                ? Shadow::both_lit
                   : blocked == blocked_by_departed_sphere ? Shadow::own_shadow
                                                           : Shadow::false_shadow;
        case TrueShadow::shadowed: return is_dark ? Shadow::both_shadowed : Shadow::false_light;
    }
    return Shadow::not_compared;
}

/// Renders one form in one format on one band.
class RowRenderer {
public:
    RowRenderer(const RenderStudy& study, const TestedForm& tested_form, const SharedRenderInputs& shared)
        : study_(study),
          row_(tested_form),
          band_(shared.band),
          inputs_(shared.inputs.at(tested_form.format.name)),
          true_pixels_(shared.true_pixels),
          appearance_(study.scene.appearance),
          pixel_count_(shared.band.pixel_count()),
          rays_(inputs_.geometry.rays_for(*tested_form.form->info)),
          result_{shared.band.y0(),
                  shared.band.scanlines(),
                  inputs_.geometry.rays.width,
                  answer::evaluate(*tested_form.form, inputs_.geometry),
                  shared.true_pixels,
                  std::vector<SeenContent>(pixel_count_),
                  {},
                  std::vector<double>(pixel_count_, missing),
                  std::vector<double>(pixel_count_, missing),
                  {},
                  std::vector<std::int32_t>(pixel_count_, -1)} {}

    RenderBand render() {
        points_.assign(pixel_count_, Vec<double>(missing, missing, missing));
        normals_ = points_;
        compute_points();
        for (const Stage stage : study_.stages) casts_shadows_ |= make_shade_rule(appearance_, stage).has_shadows;
        blocker_bits_.assign(pixel_count_, blocked_by_nothing);
        if (casts_shadows_) find_shadows();
        for (const Stage stage : study_.stages) paint_stage(stage);
        return std::move(result_);
    }

private:
    [[nodiscard]] bool has_hit(std::size_t i) const { return answers_.hit[i] != 0; }
    [[nodiscard]] Primitive<double> hit_primitive(std::size_t i) const {
        return inputs_.geometry.primitives[answers_.primitive[i]];
    }
    [[nodiscard]] bool takes_unit() const { return row_.form->info->direction == intersect::Direction::unit; }

    /// Computes the point and the normal in the format, and their errors.
    void compute_points() {
        const metric::Metric& residual = *metric::find_metric("residual");
        for_each_pixel_in(row_.format, pixel_count_, study_.limit.stop, [&]<class T>(std::size_t i) {
            const Truth& ray_truth = band_.truth(i, intersect::Touching::hit);
            result_.true_primitive[i] = ray_truth.is_hit() ? ray_truth.primitive : -1;
            result_.seen[i] = content_of(ray_truth, has_hit(i), answers_.t[i], answers_.primitive[i]);
            if (!has_hit(i)) return;

            const Ray<double> ray = rays_[i];
            const Vec<T> point = point_at<T>(lift_ray<T>(ray), static_cast<T>(answers_.t[i]));
            const Primitive<double> primitive_seen = hit_primitive(i);
            const auto lifted_primitive = lift_primitive<T>(primitive_seen);
            points_[i] = as_doubles(point);
            normals_[i] = as_doubles(primitive_seen.transform ? normal_in_world<T>(lifted_primitive, ray, answers_.t[i])
                                                              : normal_at<T>(point, lifted_primitive));

            // Errors are measured only where the form sees the true sphere.
            if (result_.seen[i] != SeenContent::same_sphere) return;
            result_.residual[i] = std::fabs(residual.value(
                {.t = answers_.t[i], .format = &row_.format, .ray = &ray, .primitive = &primitive_seen}));
            if (true_pixels_[i].has_normal)
                result_.normal_angle[i] = angle_between(normals_[i], true_pixels_[i].normal);
        });
    }

    /// Returns the normal in world space. It is computed in object space, to which the form's own transform method
    /// takes the ray, then multiplied by A⁻ᵀ and made unit. A transform method that uses adj(A) in place of A⁻¹ works
    /// with a primitive |det A| times as large, so its ray is divided by that factor here.
    template <class T>
    [[nodiscard]] Vec<T> normal_in_world(const Primitive<T>& primitive, const Ray<double>& ray, double t) const {
        const auto& steps = intersect::transform::step_functions<T>(
            *intersect::transform::find_transformed_parts(
                 intersect::bounding_box::without_world_boxes(row_.form->form_for(primitive.shape)))
                 .method);
        const auto maps = steps.maps(*primitive.transform);
        const auto object_ray = steps.to_object(maps, lift_ray<T>(ray));
        const Vec<T> p =
            point_at<T>({object_ray.ray.origin / object_ray.scale, object_ray.ray.direction / object_ray.scale},
                        static_cast<T>(t) * object_ray.length);
        const T sign = as_double(object_ray.scale) == 1 || primitive.transform->orientation > 0 ? T(1) : T(-1);
        return unit_of<T>(sign * times(maps.to_object.rows, normal_at<T>(p, primitive)));
    }

    struct LightRay {
        Vec<double> origin{0, 0, 0}, direction{0, 0, 0};
        double reach = 1;
    };

    /// Returns the ray to the light, computed in the format. A form that assumes unit directions gets one, and `reach`
    /// is then the distance of the light as the format computes it.
    template <class T>
    [[nodiscard]] LightRay towards_light(std::size_t i) const {
        const auto& rule = *appearance_.shadows;
        const Vec<T> light = lift_vec<T>(inputs_.appearance.light);
        Vec<T> start = has_hit(i) ? lift_vec<T>(points_[i]) : lift_vec<T>(inputs_.points[i]);
        if (has_hit(i) && rule.tests_departed_sphere)
            start = shadow_origin<T>(start, lift_vec<T>(normals_[i]), rule.offset,
                                     static_cast<T>(inputs_.appearance.epsilon), rule.ulps);
        const Vec<T> to_light = light - start;
        LightRay light_ray{as_doubles(start), as_doubles(to_light), 1};
        if (takes_unit() && is_finite(light_ray.direction)) {
            light_ray.reach = as_double(length(to_light));
            light_ray.direction = truth::unit_direction(light_ray.direction, row_.format.parameters);
        }
        return light_ray;
    }

    /// Finds what blocks the light of each point, and compares the shadows with the true ones.
    void find_shadows() {
        std::vector<LightRay> light_rays(pixel_count_);
        const auto has_light_ray = [&](std::size_t i) {
            return has_hit(i) ? !std::isnan(answers_.t[i]) : !inputs_.points.empty();
        };
        for_each_pixel_in(row_.format, pixel_count_, study_.limit.stop, [&]<class T>(std::size_t i) {
            if (has_light_ray(i)) light_rays[i] = towards_light<T>(i);
        });

        // Tests only the pixels that have a ray to the light.
        ShadowRays shadow_rays;
        std::vector<std::size_t> ray_pixels;
        for (std::size_t i = 0; i < pixel_count_; ++i) {
            if (!has_light_ray(i)) continue;
            shadow_rays.add(light_rays[i].origin, light_rays[i].direction, light_rays[i].reach,
                            has_hit(i) ? answers_.primitive[i] : -1);
            ray_pixels.push_back(i);
        }

        const auto blocked = find_blockers(*row_.form, row_.format, shadow_rays, inputs_.geometry,
                                           appearance_.shadows->tests_departed_sphere);
        for (std::size_t k = 0; k < ray_pixels.size(); ++k) blocker_bits_[ray_pixels[k]] = blocked[k];

        result_.shadow.assign(pixel_count_, Shadow::not_compared);
        for (std::size_t i = 0; i < pixel_count_; ++i) {
            const bool is_compared =
                result_.seen[i] == SeenContent::background ||
                (result_.seen[i] == SeenContent::same_sphere &&
                 (true_pixels_[i].faces_light || true_pixels_[i].shadow == TrueShadow::unresolved));
            if (is_compared) result_.shadow[i] = compare_shadows(true_pixels_[i].shadow, blocker_bits_[i]);
        }
    }

    void paint_stage(Stage stage) {
        const ShadeRule rule = make_shade_rule(appearance_, stage);
        auto& picture = result_.painted.emplace_back(pixel_count_);
        for_each_pixel_in(row_.format, pixel_count_, study_.limit.stop, [&]<class T>(std::size_t i) {
            PaintedPixel& painted = picture[i];
            if (has_hit(i) && std::isnan(answers_.t[i])) painted.colour = Vec<double>(missing, missing, missing);
            else painted.colour = as_doubles(has_hit(i) ? surface_colour<T>(rule, i) : background_colour<T>(rule, i));

            const TrueColour& true_colour = true_pixels_[i].colours[static_cast<std::size_t>(stage)];
            painted.error = true_colour.is_certain ? 0 : missing;
            for (int k = 0; k < 3; ++k) {
                const TwoPartNumber& true_channel = true_colour.channel[k];
                const double channel_error = 255 * std::fabs((painted.colour[k] - true_channel.hi) - true_channel.lo);
                painted.error = std::isnan(channel_error) || std::isnan(painted.error)
                                    ? missing
                                    : std::max(painted.error, channel_error);
                painted.byte[k] = byte_of(painted.colour[k]);
            }
        });
    }

    template <class T>
    [[nodiscard]] Vec<T> surface_colour(const ShadeRule& rule, std::size_t i) const {
        const Paint<T> sphere_paint = lift_numbers(inputs_.appearance.paints[answers_.primitive[i]], lift<T, double>);
        const Vec<T> p = lift_vec<T>(points_[i]);
        return shade<T>(sphere_paint, rule, blocker_bits_[i] != blocked_by_nothing,
                        {lift_vec<T>(normals_[i]), unit_of<T>(lift_vec<T>(inputs_.appearance.light) - p),
                         unit_of<T>(lift_vec<T>(rays_[i].origin) - p)});
    }

    template <class T>
    [[nodiscard]] Vec<T> background_colour(const ShadeRule& rule, std::size_t i) const {
        const Vec<T> unshadowed = lift_vec<T>(inputs_.appearance.background);
        if (!rule.has_shadows || blocker_bits_[i] == blocked_by_nothing) return unshadowed;
        const T factor = static_cast<T>(inputs_.appearance.shadow_on_background);
        return Vec<T>(factor * unshadowed.x, factor * unshadowed.y, factor * unshadowed.z);
    }

    const RenderStudy& study_;
    const TestedForm& row_;
    const Band& band_;
    const FormatRenderInputs& inputs_;
    std::span<const TruePixel> true_pixels_;
    const scene::file::Appearance& appearance_;
    std::size_t pixel_count_;
    const scene::rays::RayBlock& rays_;
    RenderBand result_;
    const answer::Answers& answers_ = result_.answers;
    bool casts_shadows_ = false;
    std::vector<Vec<double>> points_, normals_;
    std::vector<std::uint8_t> blocker_bits_;
};

}  // namespace

std::uint8_t byte_of(double channel) {
    if (!(channel > 0)) return 0;
    return static_cast<std::uint8_t>(std::min(255.0, std::floor(std::fma(255.0, std::min(channel, 2.0), 0.5))));
}

RenderStudy::Summary RenderStudy::begin(std::size_t) const {
    Summary summary(stages.size());
    for (std::size_t s = 0; s < stages.size(); ++s) {
        summary[s].stage = stages[s];
        summary[s].rule = make_shade_rule(scene.appearance, stages[s]);
    }
    return summary;
}

SharedRenderInputs RenderStudy::prepare(const truth::Band& band) const {
    std::map<std::string, truth::BandNeeds> needs;
    for (const TestedForm& tested_form : tested_forms)
        needs[tested_form.format.name].unit_rays |= tested_form.form->info->direction == intersect::Direction::unit;
    SharedRenderInputs shared{
        band, find_true_picture(scene, band, stages, limit), {}, make_input_appearance(scene, binary64)};
    for (const auto& [name, format_needs] : needs) {
        const Format format = *find_format(name);
        shared.inputs.emplace(
            name, FormatRenderInputs{
                      band.inputs(format, format_needs), make_input_appearance(scene, format.parameters),
                      make_input_pixel_points(scene, band.y0(), band.y0() + band.scanlines(), format.parameters)});
    }
    return shared;
}

RenderBand RenderStudy::measure(const SharedRenderInputs& shared, std::size_t form_index, Summary& summary) const {
    RenderBand result = RowRenderer(*this, tested_forms[form_index], shared).render();
    for (std::size_t s = 0; s < stages.size(); ++s) add_to_summary(result, s, shared.appearance, summary[s]);
    return result;
}

}  // namespace lostbits::measure::render
