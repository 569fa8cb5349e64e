// Measures claims about scenes: mapped, or marched through.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>

#include "measure/answer/one_ray.hpp"
#include "measure/claim/claim_columns.hpp"
#include "measure/claim/claim_subjects.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/evaluate/measure_row.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::measure::claim {

using attribution::OwnedSetting;
using evaluate::TestedForm;
using scene::claim::Claim;
using scene::claim::SceneSubject;
using truth::missing;

namespace {

/// One number of one step of a march along the scene's first pixel.
double trace_value(const Claim& claim, int step, const scene::file::Scene& scene, truth::TruthLimit limit) {
    const TestedForm row = row_for(claim, scene);
    if (!row.form->log) scene::toml::fail(claim.where, claim.form + " does not march; `step` is for sdf.* forms");
    const intersect::table::MarchLog log = answer::march_log(*row.form, row.format, answer::OneRay(scene, 0, 0, limit));
    if (claim.metric == "steps") return static_cast<double>(log.steps.size());
    if (claim.metric == "hit") return log.hit.hit ? 1 : 0;
    if (claim.metric == "end") return log.hit.t;
    if (static_cast<std::size_t>(step) >= log.steps.size()) return missing;
    const intersect::MarchStep& s = log.steps[static_cast<std::size_t>(step)];
    const std::map<std::string, double> columns{{"t", s.t},   {"x", s.p.x},       {"y", s.p.y},
                                                {"z", s.p.z}, {"length", s.size}, {"d", s.d}};
    const auto found = columns.find(claim.metric);
    if (found == columns.end())
        scene::toml::fail(claim.where,
                          "unknown metric \"" + claim.metric +
                              "\"; a step has t, x, y, z, length and d, and a march has steps, hit and end");
    return found->second;
}

/// Summary of the pixel of a claim, as if the map had no other.
evaluate::FormSummary summary_of_pixel(const Claim& claim, const scene::file::Scene& scene, const TestedForm& row,
                                       const std::vector<const metric::Metric*>& metrics, truth::TruthLimit limit) {
    const auto [x, y] = *claim.on<SceneSubject>()->pixel;
    if (x >= scene.width || y >= scene.height)
        scene::toml::fail(claim.where, fmt::format("pixel [{}, {}] is outside the picture of {}, which has columns 0 "
                                                   "to {} and rows 0 to {}",
                                                   x, y, scene.id, scene.width - 1, scene.height - 1));
    const auto* const generator = scene::rays::generator_of(*row.form);
    const scene::file::Scene made = generator ? with_rays(scene, *generator) : scene;
    culling::Culler culler(made);
    truth::Band line(made, y, y + 1, limit, &culler);
    const evaluate::SharedBandTruth shared(line, {row}, metrics);
    evaluate::FormSummary of_line(metrics), of_pixel(metrics);
    const auto place = static_cast<std::uint32_t>(x);
    const evaluate::RaySubset part{std::span(&place, 1), &of_pixel};
    evaluate::measure_row({row, metrics}, shared.of(row), of_line, std::span(&part, 1));
    return of_pixel;
}

}  // namespace

scene::file::Scene one_scene(const Claim& claim, const ClaimRequest& run) {
    const std::string& called = claim.subject_name();
    const auto name = find_for_claim(claim, [&] { return scene::file::find_scene(called, run.data_dir); });
    auto scenes = scene::file::load_scene(name.path, {.variant = name.variant, .stop = run.stop});
    if (scenes.size() != 1)
        scene::toml::fail(claim.where,
                          "scene \"" + called + "\" has variants; name one, such as \"" + scenes.front().id + "\"");
    return std::move(scenes.front());
}

void measure(const SubjectClaims<SceneSubject>& claims, const ClaimRequest& run) {
    const scene::file::Scene scene = one_scene(claims.front().claim, run);
    SubjectClaims<SceneSubject> pictures;
    for (const auto& asked : claims) {
        const auto& [claim, on, result] = asked;
        if (on.step) result = judge(claim, trace_value(claim, *on.step, scene, {.stop = run.stop}), nullptr);
        else pictures.push_back(asked);
    }
    if (pictures.empty()) return;
    evaluate::MapStudy request{.scene = &scene, .rows = {}, .metrics = {}, .limit = {.stop = run.stop}};
    std::vector<std::size_t> rows;
    for (const auto& asked : pictures) rows.push_back(place_or_added(request.rows, row_for(asked.claim, scene)));
    const OwnedSetting setting(scene);
    const ClaimColumns columns(claims_in(pictures), request.rows, setting.get());
    request.metrics = columns.metrics();
    const auto whole = [](const auto& asked) { return !asked.on.pixel; };
    const auto summaries =
        std::ranges::any_of(pictures, whole) ? evaluate::run_map(request) : std::vector<evaluate::FormSummary>();
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        const auto& [claim, on, result] = pictures[k];
        const TestedForm& row = request.rows[rows[k]];
        const evaluate::FormSummary one =
            on.pixel ? summary_of_pixel(claim, scene, row, request.metrics, request.limit) : evaluate::FormSummary();
        const evaluate::FormSummary& summary = on.pixel ? one : summaries[rows[k]];
        result = judge(claim, columns.value(claim, summary), &summary);
    }
}

}  // namespace lostbits::measure::claim
