// Collects the answers of rows of the table of forms, in which suspicions look for a mistake.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measure/answer/owners.hpp"
#include "measure/contract/suspect.hpp"
#include "measure/evaluate/culprit_order.hpp"
#include "measure/truth/lost_bits.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::measure::contract {
namespace {

constexpr std::size_t max_rays = 4096;

/// Appends the answers of a row on the rays of a band to `rays`.
void collect_samples(const truth::Band& band, const evaluate::TestedForm& tested_form,
                     std::vector<AnswerSample>& rays) {
    const truth::FormatInputs in = band.inputs_for(tested_form.format, *tested_form.form->info);
    const answer::Answers answers = answer::evaluate(*tested_form.form, in);
    for (std::size_t i = 0; i < band.pixel_count() && rays.size() < max_rays; ++i) {
        const truth::Truth& ray_truth = band.truth(i, tested_form.convention());
        if (ray_truth.decision == truth::Truth::Decision::unresolved) continue;
        const std::size_t primitive =
            answer::measured_primitive(in, i, ray_truth.is_hit() ? ray_truth.primitive : answers.primitive[i]);
        rays.push_back(make_answer_sample(in.rays_for(*tested_form.form->info)[i], in.primitives[primitive], ray_truth,
                                          tested_form, answers.hit[i] != 0, answers.t[i]));
    }
}

}  // namespace

AnswerSample make_answer_sample(const Ray<double>& ray, const Primitive<double>& primitive,
                                const truth::Truth& ray_truth, const evaluate::TestedForm& tested_form, bool hit,
                                double t) {
    const bool is_unit = tested_form.form->info->direction == intersect::Direction::unit;
    const FloatFormat& format = tested_form.format.parameters;
    if (tested_form.form->info->roots == intersect::Roots::none) t = std::nan("");
    AnswerSample sample{
        .ray = ray, .primitive = primitive, .truly_hits = ray_truth.is_hit(), .is_unit = is_unit, .hit = hit, .t = t};
    const auto to_double = [](const truth::CertifiedNumber& x) {
        return std::ldexp(x.hi, static_cast<int>(x.exponent));
    };
    if (ray_truth.is_hit()) {
        sample.true_t = to_double(is_unit ? ray_truth.distance : ray_truth.t);
        sample.other_t = to_double(is_unit ? ray_truth.t : ray_truth.distance);
        // The format has no better answer than infinity.
        if (hit && std::isinf(t) && truth::ulp_error(t, is_unit ? ray_truth.distance : ray_truth.t, format) == 0)
            sample.true_t = t;
    }
    return sample;
}

std::string name_counted_rays(const std::string& where, std::uint64_t sampled, std::uint64_t total,
                              const std::string& counted_rays_text, const std::string& suspicion) {
    if (suspicion.empty()) return "";
    const std::string rays =
        sampled >= total ? fmt::format("on all {} of {}: ", text::count_with_noun(total, "ray"), where)
                         : fmt::format("on a sample of {}, the first {} {}: ", where, sampled, counted_rays_text);
    return rays + suspicion;
}

std::string suspicion_text(const scene::file::Scene& scene, const evaluate::TestedForm& tested_form) {
    const scene::file::Scene small_scene = evaluate::small_picture_of(scene, 64);
    culling::Culler culler(small_scene);
    std::vector<AnswerSample> rays;
    collect_samples(truth::Band(small_scene, 0, small_scene.height, {}, &culler), tested_form, rays);
    const std::string text = suspicion_text(rays);
    if (text.empty() || small_scene.pixel_count() == scene.pixel_count())
        return name_counted_rays(scene.id, small_scene.pixel_count(), small_scene.pixel_count(), "", text);
    return fmt::format("on a sample of {}, a picture of {}x{} with {} rays: {}", scene.id, small_scene.width,
                       small_scene.height, small_scene.pixel_count(), text);
}

std::string suspicion_text(std::vector<scene::rays::RayGroup> groups, const evaluate::TestedForm& tested_form,
                           const std::string& where) {
    std::vector<AnswerSample> rays;
    std::uint64_t total = 0, sampled = 0;
    for (scene::rays::RayGroup& group : groups) {
        total += group.rays.size();
        if (rays.size() >= max_rays) continue;
        sampled += std::min(group.rays.size(), max_rays - rays.size());
        collect_samples(truth::Band(std::move(group)), tested_form, rays);
    }
    return name_counted_rays(where, sampled, total, "of its rays", suspicion_text(rays));
}

}  // namespace lostbits::measure::contract
