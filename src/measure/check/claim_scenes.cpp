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

/// Number of a march along the ray of the first pixel of a scene, or of one step of this march.
double trace_value(const Claim& claim, int step, const scene::file::Scene& scene, truth::ProofLimit limit) {
    const TestedForm tested_form = tested_form_for(claim, scene);
    if (!tested_form.form->log)
        scene::toml::fail(claim.where, claim.form + " does not march; `step` is for sdf.* forms");
    const intersect::table::MarchLog log =
        answer::march_log(*tested_form.form, tested_form.format, answer::OneRay(scene, 0, 0, limit));
    if (claim.metric == "steps") return static_cast<double>(log.steps.size());
    if (claim.metric == "hit") return log.hit.hit ? 1 : 0;
    if (claim.metric == "end") return log.hit.t;
    if (static_cast<std::size_t>(step) >= log.steps.size()) return missing;
    const intersect::MarchStep& march_step = log.steps[static_cast<std::size_t>(step)];
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
    truth::Band row_band(generated_scene, y, y + 1, limit, &culler);
    const evaluate::SharedBandTruth shared(row_band, {tested_form}, metrics);
    evaluate::FormSummary row_summary(metrics), pixel_summary(metrics);
    const auto column = static_cast<std::uint32_t>(x);
    const evaluate::RaySubset pixel_subset{std::span(&column, 1), &pixel_summary};
    evaluate::measure_form({tested_form, metrics}, shared.inputs_of(tested_form), row_summary,
                           std::span(&pixel_subset, 1));
    return pixel_summary;
}

}  // namespace

scene::file::Scene one_scene(const Claim& claim, const ClaimRequest& run) {
    const std::string& subject_name = claim.subject_name();
    const auto name = find_for_claim(claim, [&] { return scene::file::find_scene(subject_name, run.data_dir); });
    auto scenes = scene::file::load_scene(name.path, {.variant = name.variant, .stop = run.stop});
    if (scenes.size() != 1)
        scene::toml::fail(claim.where, "scene \"" + subject_name + "\" has variants; name one, such as \"" +
                                           scenes.front().id + "\"");
    return std::move(scenes.front());
}

void measure(const SubjectClaims<SceneSubject>& claims, const ClaimRequest& run) {
    const scene::file::Scene scene = one_scene(claims.front().claim, run);

    // Claims about a step of a march are judged alone, the others together.
    SubjectClaims<SceneSubject> pictures;
    for (const auto& subject_claim : claims) {
        const auto& [claim, subject, result] = subject_claim;
        if (subject.step) result = judge(claim, trace_value(claim, *subject.step, scene, {.stop = run.stop}), nullptr);
        else pictures.push_back(subject_claim);
    }
    if (pictures.empty()) return;

    evaluate::MapStudy request{.scene = &scene, .tested_forms = {}, .metrics = {}, .limit = {.stop = run.stop}};
    std::vector<std::size_t> rows;
    for (const auto& subject_claim : pictures)
        rows.push_back(find_or_add_tested_form(request.tested_forms, tested_form_for(subject_claim.claim, scene)));
    const OwnedSetting setting(scene);
    const ClaimColumns columns(claim_pointers(pictures), request.tested_forms, setting.get());
    request.metrics = columns.metrics();

    // The whole picture is measured only if a claim is about it.
    const auto is_whole_picture = [](const auto& subject_claim) { return !subject_claim.subject.pixel; };
    const auto summaries = std::ranges::any_of(pictures, is_whole_picture) ? evaluate::run_map(request)
                                                                           : std::vector<evaluate::FormSummary>();

    for (std::size_t k = 0; k < pictures.size(); ++k) {
        const auto& [claim, subject, result] = pictures[k];
        const TestedForm& tested_form = request.tested_forms[rows[k]];
        const evaluate::FormSummary pixel_summary =
            subject.pixel ? summarise_pixel(claim, scene, tested_form, request.metrics, request.limit)
                          : evaluate::FormSummary();
        const evaluate::FormSummary& summary = subject.pixel ? pixel_summary : summaries[rows[k]];
        result = judge(claim, columns.value(claim, summary), &summary);
    }
}

}  // namespace lostbits::measure::check
