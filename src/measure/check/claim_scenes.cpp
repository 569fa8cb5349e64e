// Measures claims about scenes: about their maps, one pixel, or a march.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>

#include "measure/answer/one_ray.hpp"
#include "measure/check/claim_columns.hpp"
#include "measure/check/claim_subjects.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/evaluate/measure_form.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::measure::check {

using attribution::OwnedSetting;
using evaluate::TestedForm;
using scene::check::Claim;
using scene::check::SceneSubject;
using truth::missing;

namespace {

/// A value of the march along the ray of the first pixel of a scene (its number of steps, hit or end), or of one of its
/// steps.
double march_value(const Claim& claim, int step, const scene::file::Scene& scene, truth::ProofLimit limit) {
    const TestedForm tested_form = tested_form_for(claim, scene);
    if (!tested_form.form->log)
        scene::toml::fail(claim.where, claim.form + " does not march; `step` is for sdf.* forms");
    const intersect::table::MarchLog log =
        answer::record_march(*tested_form.form, tested_form.format, answer::OneRay(scene, 0, 0, limit));
    if (claim.metric == "steps") return static_cast<double>(log.steps.size());
    if (claim.metric == "hit") return log.hit.hit ? 1 : 0;
    if (claim.metric == "end") return log.hit.t;
    if (static_cast<std::size_t>(step) >= log.steps.size()) return missing;
    const intersect::MarchStep& march_step = log.steps[step];
    const std::map<std::string, double> columns{{"t", march_step.t},         {"x", march_step.p.x},
                                                {"y", march_step.p.y},       {"z", march_step.p.z},
                                                {"length", march_step.size}, {"d", march_step.d}};
    const auto found = columns.find(claim.metric);
    if (found == columns.end())
        scene::toml::fail(claim.where,
                          "unknown metric \"" + claim.metric +
                              "\"; a step has t, x, y, z, length and d, and a march has steps, hit and end");
    return found->second;
}

/// Summary of the pixel of a claim, as if the map had no other pixel.
evaluate::FormSummary summarise_pixel(const Claim& claim, const scene::file::Scene& scene,
                                      const TestedForm& tested_form, const std::vector<const metric::Metric*>& metrics,
                                      truth::ProofLimit limit) {
    const auto [x, y] = *claim.subject_if<SceneSubject>()->pixel;
    if (x >= scene.width || y >= scene.height)
        scene::toml::fail(claim.where, fmt::format("pixel [{}, {}] is outside the picture of {}, which has columns 0 "
                                                   "to {} and rows 0 to {}",
                                                   x, y, scene.id, scene.width - 1, scene.height - 1));
    const auto* const generator = scene::rays::generator_of(*tested_form.form);
    const scene::file::Scene generated_scene = generator ? with_ray_generator(scene, *generator) : scene;
    culling::Culler culler(generated_scene);
    truth::Band line_band(generated_scene, y, y + 1, limit, &culler);
    const evaluate::SharedBandTruth shared(line_band, {tested_form}, metrics);
    evaluate::FormSummary line_summary(metrics), pixel_summary(metrics);
    const auto column = static_cast<std::uint32_t>(x);
    const evaluate::RaySubset pixel_subset{std::span(&column, 1), &pixel_summary};
    evaluate::measure_form({tested_form, metrics}, shared.inputs_of(tested_form), line_summary,
                           std::span(&pixel_subset, 1));
    return pixel_summary;
}

}  // namespace

scene::file::Scene load_single_scene(const Claim& claim, const ClaimRequest& run) {
    const std::string& subject_name = claim.subject_name();
    const auto name = find_for_claim(claim, [&] { return scene::file::find_scene(subject_name, run.data_dir); });
    auto scenes = scene::file::load_scene(name.path, {.variant = name.variant, .stop = run.stop});
    if (scenes.size() != 1)
        scene::toml::fail(claim.where, "scene \"" + subject_name + "\" has variants; name one, such as \"" +
                                           scenes.front().id + "\"");
    return std::move(scenes.front());
}

void measure(const SubjectClaims<SceneSubject>& claims, const ClaimRequest& run) {
    const scene::file::Scene scene = load_single_scene(claims.front().claim, run);

    // Claims about a step of a march are judged alone, the others together.
    SubjectClaims<SceneSubject> picture_claims;
    for (const auto& subject_claim : claims) {
        const auto& [claim, subject, result] = subject_claim;
        if (subject.step)
            result = judge_measured_value(claim, march_value(claim, *subject.step, scene, {.stop = run.stop}), nullptr);
        else picture_claims.push_back(subject_claim);
    }
    if (picture_claims.empty()) return;

    evaluate::MapStudy map_study{.scene = &scene, .tested_forms = {}, .metrics = {}, .limit = {.stop = run.stop}};
    std::vector<std::size_t> form_indices;
    for (const auto& subject_claim : picture_claims)
        form_indices.push_back(
            find_or_add_tested_form(map_study.tested_forms, tested_form_for(subject_claim.claim, scene)));
    const OwnedSetting setting(scene);
    const ClaimColumns columns(claim_pointers(picture_claims), map_study.tested_forms, setting.get());
    map_study.metrics = columns.metrics();

    // The whole picture is measured only if a claim is about it.
    const auto is_whole_picture = [](const auto& subject_claim) { return !subject_claim.subject.pixel; };
    const auto summaries = std::ranges::any_of(picture_claims, is_whole_picture) ? evaluate::run_map(map_study)
                                                                                 : std::vector<evaluate::FormSummary>();

    for (std::size_t k = 0; k < picture_claims.size(); ++k) {
        const auto& [claim, subject, result] = picture_claims[k];
        const TestedForm& tested_form = map_study.tested_forms[form_indices[k]];
        const evaluate::FormSummary pixel_summary =
            subject.pixel ? summarise_pixel(claim, scene, tested_form, map_study.metrics, map_study.limit)
                          : evaluate::FormSummary();
        const evaluate::FormSummary& summary = subject.pixel ? pixel_summary : summaries[form_indices[k]];
        result = judge_measured_value(claim, columns.value(claim, summary), &summary);
    }
}

}  // namespace lostbits::measure::check
