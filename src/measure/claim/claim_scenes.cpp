// Claims about scenes: mapped, marched through, or rendered.
#include <algorithm>
#include <map>
#include <set>

#include "measure/answer/one_ray.hpp"
#include "measure/claim/claim_columns.hpp"
#include "measure/claim/claim_subjects.hpp"
#include "measure/picture/render.hpp"

namespace lostbits::measure::claim {

using blame::SettingOf;
using evaluate::TestedForm;
using scene::claim::Claim;
using scene::claim::RenderSubject;
using scene::claim::SceneSubject;
using truth::missing;

namespace {

/// One number of one sample of a march along the scene's first pixel.
double trace_value(const Claim& claim, int step, const scene::file::Scene& scene, truth::TruthLimit limit) {
    const TestedForm row = row_for(claim, scene);
    if (!row.form->log)
        scene::toml::fail(claim.where, claim.form + " does not march; `step` is for the forms of sdf.*");
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

/// What a picture can be made by.
struct Rendered {
    [[nodiscard]] static bool meets(Shapes forms) { return forms == scene::file::rendered_shape; }
};

}  // namespace

scene::file::Scene one_scene(const Claim& claim, const ClaimRequest& run) {
    const std::string& called = claim.subject_name();
    const auto name = find_or_blame_claim(claim, [&] { return scene::file::find_scene(called, run.data_dir); });
    auto scenes = scene::file::load_scene(name.path, {.variant = name.variant, .stop = run.stop});
    if (scenes.size() != 1)
        scene::toml::fail(claim.where,
                          "scene \"" + called + "\" has variants; name one, such as \"" + scenes.front().id + "\"");
    return std::move(scenes.front());
}

void measure(const ClaimsOn<SceneSubject>& claims, const ClaimRequest& run) {
    const scene::file::Scene scene = one_scene(claims.front().claim, run);
    ClaimsOn<SceneSubject> pictures;
    for (const auto& asked : claims) {
        const auto& [claim, on, result] = asked;
        if (on.step) result = judge(claim, trace_value(claim, *on.step, scene, {.stop = run.stop}), nullptr);
        else pictures.push_back(asked);
    }
    if (pictures.empty()) return;
    evaluate::EvaluationRequest request{.scene = &scene, .rows = {}, .metrics = {}, .limit = {.stop = run.stop}};
    std::vector<std::size_t> rows;
    for (const auto& asked : pictures) rows.push_back(place_or_added(request.rows, row_for(asked.claim, scene)));
    const SettingOf setting(scene);
    const ClaimColumns columns(claims_in(pictures), request.rows, setting.get());
    request.metrics = columns.metrics();
    const auto summaries = evaluate::evaluate_rows(request, {});
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        const auto& [claim, on, result] = pictures[k];
        result = judge(claim, columns.value(claim, summaries[rows[k]]), &summaries[rows[k]]);
    }
}

/// The claims about one rendered scene: one run, all stages that they name.
void measure(const ClaimsOn<RenderSubject>& claims, const ClaimRequest& run) {
    const Claim& first = claims.front().claim;
    const scene::file::Scene scene = one_scene(first, run);
    const std::string called = "scene \"" + first.subject_name() + "\"";
    if (!scene.meets(scene::file::rendered_shape)) scene::toml::fail(first.where, called + " has no spheres to render");
    const scene::file::Appearance& look = scene.appearance;
    picture::RenderRequest request{.scene = scene, .stages = {}, .rows = {}, .limit = {.stop = run.stop}};
    std::set<scene::file::Stage> stages;
    for (const auto& [claim, on, result] : claims) {
        const scene::file::Stage stage = on.stage.value_or(look.furthest());
        if (!look.asks_for(stage))
            scene::toml::fail(claim.where, called + " has no stage " + std::string(name_of(stage)));
        stages.insert(stage);
        request.rows.push_back(row_for(claim, Rendered{}));
    }
    request.stages.assign(stages.begin(), stages.end());
    const auto summaries = picture::run_render(request);
    for (std::size_t k = 0; k < claims.size(); ++k) {
        const auto& [claim, on, result] = claims[k];
        const auto stage =
            std::ranges::find(request.stages, on.stage.value_or(look.furthest())) - request.stages.begin();
        const picture::RenderSummary& s = summaries[k * request.stages.size() + static_cast<std::size_t>(stage)];
        const auto& column =
            column_named(picture::render_columns(), claim.metric, claim.where.text(), " of a rendered scene");
        result = judge(claim, column.value(s), nullptr);
        require_proof(result, s.unresolved(), "pixel is not proved", "pixels are not proved");
    }
}

}  // namespace lostbits::measure::claim
