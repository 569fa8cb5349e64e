#include "measure/picture/render.hpp"

#include <algorithm>
#include <cmath>

#include "intersect/bounding_box/behind.hpp"
#include "intersect/process/parallel.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/picture/blockers.hpp"
#include "measure/picture/stored_appearance.hpp"
#include "measure/truth/unit_direction.hpp"
#include "number/with_number.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::picture {

using evaluate::TestedForm;
using scene::file::Stage;
using truth::Band;
using truth::missing;
using truth::Truth;

namespace {

/// Calls `work.operator()<T>(i)` for every pixel, T the number that the format is evaluated in.
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

Seen seen_of(const Truth& truth, bool hit, double t, std::int32_t object) {
    if (truth.decision == Truth::Decision::unresolved) return Seen::unresolved;
    if (hit && std::isnan(t)) return Seen::not_a_number;
    if (!truth.is_hit()) return hit ? Seen::extra_sphere : Seen::background;
    if (!hit) return Seen::lost_sphere;
    return object == truth.object ? Seen::same_sphere : Seen::other_sphere;
}

/// Angle between n as computed (of any length) and the true unit normal N: atan2(|n × N|, n·N). The products are in
/// double-double, because the cross product of vectors 2^-53 apart is all cancellation.
double angle_between(const Vec<double>& n, const std::array<Tight, 3>& truth) {
    if (!is_finite(n)) return missing;
    const Vec<Ball> a(Ball(n.x), Ball(n.y), Ball(n.z));
    const auto ball = [](const Tight& x) { return Ball(x.hi, x.lo, 0); };
    const Vec<Ball> b(ball(truth[0]), ball(truth[1]), ball(truth[2]));
    const Vec<Ball> c = cross<Ball>(a, b);
    const double across = std::sqrt(c.x.hi() * c.x.hi() + c.y.hi() * c.y.hi() + c.z.hi() * c.z.hi());
    return std::atan2(across, dot<Ball>(a, b).hi());
}

Shadow compare(TrueShadow truth, std::uint8_t blocked) {
    const bool dark = blocked != blocked_by_nothing;
    switch (truth) {
        case TrueShadow::untested: return Shadow::not_compared;
        case TrueShadow::unresolved: return Shadow::unresolved;
        case TrueShadow::lit:
            return !dark                               ? Shadow::both_lit
                   : blocked == blocked_by_left_sphere ? Shadow::own_shadow
                                                       : Shadow::false_shadow;
        case TrueShadow::shadowed: return dark ? Shadow::both_shadowed : Shadow::false_light;
    }
    return Shadow::not_compared;
}

/// Renders one form in one format on one band.
class RowRenderer {
public:
    RowRenderer(const RenderStudy& study, const TestedForm& row, const SharedRenderInputs& on)
        : study_(study),
          row_(row),
          band_(on.band),
          in_(on.inputs.at(row.format.name)),
          truth_(on.truth),
          appearance_(study.scene.appearance),
          n_(on.band.pixels()),
          rays_(in_.geometry.rays_for(*row.form->info)),
          out_{on.band.y0(),
               on.band.rows(),
               in_.geometry.rays.width,
               answer::evaluate(*row.form, in_.geometry),
               on.truth,
               std::vector<Seen>(n_),
               {},
               std::vector<double>(n_, missing),
               std::vector<double>(n_, missing),
               {},
               std::vector<std::int32_t>(n_, -1)} {}

    RenderBand render() {
        point_.assign(n_, Vec<double>(missing, missing, missing));
        normal_ = point_;
        see();
        for (const Stage stage : study_.stages) casts_ |= shade_rule(appearance_, stage).shadows;
        blocked_.assign(n_, blocked_by_nothing);
        if (casts_) cast();
        for (const Stage stage : study_.stages) paint(stage);
        return std::move(out_);
    }

private:
    [[nodiscard]] bool hit(std::size_t i) const { return answers_.hit[i] != 0; }
    [[nodiscard]] Primitive<double> primitive(std::size_t i) const {
        return in_.geometry.primitives[static_cast<std::size_t>(answers_.object[i])];
    }
    [[nodiscard]] bool unit() const { return row_.form->info->direction == intersect::Direction::unit; }

    /// Computes the point and the normal in the format, and their errors.
    void see() {
        const metric::Metric& residual = *metric::find_metric("residual");
        for_each_pixel_in(row_.format, n_, study_.limit.stop, [&]<class T>(std::size_t i) {
            const Truth& truth = band_.truth(i, intersect::Touching::hit);
            out_.truth_object[i] = truth.is_hit() ? truth.object : -1;
            out_.seen[i] = seen_of(truth, hit(i), answers_.t[i], answers_.object[i]);
            if (!hit(i)) return;
            const Ray<double> ray = rays_[i];
            const Vec<T> p = point_at<T>(lift_ray<T>(ray), static_cast<T>(answers_.t[i]));
            const Primitive<double> seen = primitive(i);
            const auto lifted_primitive = lift_primitive<T>(seen);
            point_[i] = as_doubles(p);
            normal_[i] = as_doubles(seen.placed ? normal_under_matrix<T>(lifted_primitive, ray, answers_.t[i])
                                                : normal_at<T>(p, lifted_primitive));
            if (out_.seen[i] != Seen::same_sphere) return;
            out_.residual[i] = std::fabs(
                residual.value({.t = answers_.t[i], .format = &row_.format, .ray = &ray, .primitive = &seen}));
            if (truth_[i].has_normal) out_.normal_angle[i] = angle_between(normal_[i], truth_[i].normal);
        });
    }

    /// Normal in world space: the normal in object space, where the form's own transform method takes the ray, times
    /// A⁻ᵀ and made unit. A transform method that takes adj(A) in place of A⁻¹ works with a primitive |det A| times as
    /// large, so its ray is divided by that factor here.
    template <class T>
    [[nodiscard]] Vec<T> normal_under_matrix(const Primitive<T>& primitive, const Ray<double>& ray, double t) const {
        const auto& steps = intersect::transform::steps_in<T>(
            *intersect::transform::transformed_parts_of(
                 intersect::bounding_box::without_world_boxes(row_.form->of(primitive.shape)))
                 .method);
        const auto maps = steps.maps(*primitive.placed);
        const auto in = steps.to_object(maps, lift_ray<T>(ray));
        const Vec<T> p =
            point_at<T>({in.ray.origin / in.scale, in.ray.direction / in.scale}, static_cast<T>(t) * in.length);
        const T sign = as_double(in.scale) == 1 || primitive.placed->orientation > 0 ? T(1) : T(-1);
        return unit_of<T>(sign * times(maps.to_object.rows, normal_at<T>(p, primitive)));
    }

    struct Cast {
        Vec<double> origin{0, 0, 0}, direction{0, 0, 0};
        double reach = 1;
    };

    /// Ray to the light, computed in the format. A form that asks for unit directions gets one, and `reach` is then the
    /// distance of the light as the format computes it.
    template <class T>
    [[nodiscard]] Cast towards_light(std::size_t i) const {
        const auto& rule = *appearance_.shadows;
        const Vec<T> light = lift_vec<T>(in_.look.light);
        Vec<T> start = hit(i) ? lift_vec<T>(point_[i]) : lift_vec<T>(in_.points[i]);
        if (hit(i) && rule.tests_left_sphere)
            start = shadow_origin<T>(start, lift_vec<T>(normal_[i]), rule.offset, static_cast<T>(in_.look.epsilon),
                                     rule.ulps);
        const Vec<T> way = light - start;
        Cast cast{as_doubles(start), as_doubles(way), 1};
        if (unit() && is_finite(cast.direction)) {
            cast.reach = as_double(length(way));
            cast.direction = truth::unit_direction(cast.direction, row_.format.parameters);
        }
        return cast;
    }

    void cast() {
        std::vector<Cast> casts(n_);
        const auto is_cast = [&](std::size_t i) { return hit(i) ? !std::isnan(answers_.t[i]) : !in_.points.empty(); };
        for_each_pixel_in(row_.format, n_, study_.limit.stop, [&]<class T>(std::size_t i) {
            if (is_cast(i)) casts[i] = towards_light<T>(i);
        });
        ShadowRays shadow;
        std::vector<std::size_t> pixel;
        for (std::size_t i = 0; i < n_; ++i) {
            if (!is_cast(i)) continue;
            shadow.add(casts[i].origin, casts[i].direction, casts[i].reach, hit(i) ? answers_.object[i] : -1);
            pixel.push_back(i);
        }
        const auto blocked =
            find_blockers(*row_.form, row_.format, shadow, in_.geometry, appearance_.shadows->tests_left_sphere);
        for (std::size_t k = 0; k < pixel.size(); ++k) blocked_[pixel[k]] = blocked[k];

        out_.shadow.assign(n_, Shadow::not_compared);
        for (std::size_t i = 0; i < n_; ++i) {
            const bool compared = out_.seen[i] == Seen::background ||
                                  (out_.seen[i] == Seen::same_sphere &&
                                   (truth_[i].faces_light || truth_[i].shadow == TrueShadow::unresolved));
            if (compared) out_.shadow[i] = compare(truth_[i].shadow, blocked_[i]);
        }
    }

    void paint(Stage stage) {
        const ShadeRule rule = shade_rule(appearance_, stage);
        auto& picture = out_.painted.emplace_back(n_);
        for_each_pixel_in(row_.format, n_, study_.limit.stop, [&]<class T>(std::size_t i) {
            Painted& p = picture[i];
            if (hit(i) && std::isnan(answers_.t[i])) p.colour = Vec<double>(missing, missing, missing);
            else p.colour = as_doubles(hit(i) ? surface<T>(rule, i) : background<T>(rule, i));
            const TrueColour& truth = truth_[i].colours[static_cast<std::size_t>(stage)];
            p.error = truth.certain ? 0 : missing;
            for (int k = 0; k < 3; ++k) {
                const Tight& c = truth.channel[static_cast<std::size_t>(k)];
                const double off = 255 * std::fabs((p.colour[k] - c.hi) - c.lo);
                p.error = std::isnan(off) || std::isnan(p.error) ? missing : std::max(p.error, off);
                p.byte[static_cast<std::size_t>(k)] = byte_of(p.colour[k]);
            }
        });
    }

    template <class T>
    [[nodiscard]] Vec<T> surface(const ShadeRule& rule, std::size_t i) const {
        const Paint<T> paint = lifted(in_.look.paints[static_cast<std::size_t>(answers_.object[i])], lift<T, double>);
        const Vec<T> p = lift_vec<T>(point_[i]);
        return shade<T>(paint, rule, blocked_[i] != blocked_by_nothing,
                        {lift_vec<T>(normal_[i]), unit_of<T>(lift_vec<T>(in_.look.light) - p),
                         unit_of<T>(lift_vec<T>(rays_[i].origin) - p)});
    }

    template <class T>
    [[nodiscard]] Vec<T> background(const ShadeRule& rule, std::size_t i) const {
        const Vec<T> full = lift_vec<T>(in_.look.background);
        if (!rule.shadows || blocked_[i] == blocked_by_nothing) return full;
        const T factor = static_cast<T>(in_.look.shadow_on_background);
        return Vec<T>(factor * full.x, factor * full.y, factor * full.z);
    }

    const RenderStudy& study_;
    const TestedForm& row_;
    const Band& band_;
    const FormatRenderInputs& in_;
    std::span<const TruePixel> truth_;
    const scene::file::Appearance& appearance_;
    std::size_t n_;
    const scene::rays::RayBlock& rays_;
    RenderBand out_;
    const answer::Answers& answers_ = out_.answers;
    bool casts_ = false;
    std::vector<Vec<double>> point_, normal_;
    std::vector<std::uint8_t> blocked_;
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
        summary[s].rule = shade_rule(scene.appearance, stages[s]);
    }
    return summary;
}

SharedRenderInputs RenderStudy::prepare(const truth::Band& band) const {
    std::map<std::string, truth::BandNeeds> needs;
    for (const TestedForm& row : rows)
        needs[row.format.name].unit_rays |= row.form->info->direction == intersect::Direction::unit;
    SharedRenderInputs on{band, find_true_picture(scene, band, stages, limit), {}, input_appearance(scene, binary64)};
    for (const auto& [name, need] : needs) {
        const Format format = *find_format(name);
        on.inputs.emplace(
            name, FormatRenderInputs{band.inputs(format, need), input_appearance(scene, format.parameters),
                                     input_pixel_points(scene, band.y0(), band.y0() + band.rows(), format.parameters)});
    }
    return on;
}

RenderBand RenderStudy::measure(const SharedRenderInputs& on, std::size_t row, Summary& summary) const {
    RenderBand found = RowRenderer(*this, rows[row], on).render();
    for (std::size_t s = 0; s < stages.size(); ++s) add_to_summary(found, s, on.look, summary[s]);
    return found;
}

}  // namespace lostbits::measure::picture
