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
using map::MapRow;
using scene::claim::Claim;
using truth::missing;

namespace {

/// One number of one sample of a march along the scene's first pixel.
double trace_value(const Claim& claim, const scene::file::Scene& scene, truth::TruthLimit limit) {
    const MapRow row = row_for(claim, scene);
    if (!row.form->log)
        scene::toml::fail(claim.where, claim.form + " does not march; `step` is for the forms of sdf.*");
    const intersect::table::MarchLog log = answer::march_log(*row.form, row.format, answer::OneRay(scene, 0, 0, limit));
    if (claim.metric == "steps") return static_cast<double>(log.steps.size());
    if (claim.metric == "hit") return log.hit.hit ? 1 : 0;
    if (claim.metric == "end") return log.hit.t;
    if (static_cast<std::size_t>(*claim.step) >= log.steps.size()) return missing;
    const intersect::MarchStep& s = log.steps[static_cast<std::size_t>(*claim.step)];
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

scene::file::Scene one_scene(const Claim& claim, const std::string& called, const ClaimRequest& run) {
    const auto name = find_or_blame_claim(claim, [&] { return scene::file::find_scene(called, run.data_dir); });
    auto scenes = scene::file::load_scene(name.path, {.variant = name.variant, .stop = run.stop});
    if (scenes.size() != 1)
        scene::toml::fail(claim.where,
                          "scene \"" + called + "\" has variants; name one, such as \"" + scenes.front().id + "\"");
    return std::move(scenes.front());
}

void measure_scene(const std::vector<Claim>& claims, const Places& places, const ClaimRequest& run,
                   std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const scene::file::Scene scene = one_scene(first, first.scene, run);
    Places pictures;
    for (const std::size_t i : places) {
        if (claims[i].step) results[i] = judge(claims[i], trace_value(claims[i], scene, {.stop = run.stop}), nullptr);
        else pictures.push_back(i);
    }
    if (pictures.empty()) return;
    map::MapRequest request{.scene = &scene, .rows = {}, .metrics = {}, .limit = {.stop = run.stop}};
    std::vector<std::size_t> rows;
    for (const std::size_t i : pictures) rows.push_back(place_or_added(request.rows, row_for(claims[i], scene)));
    const SettingOf setting(scene);
    const ClaimColumns columns(claims_at(claims, pictures), request.rows, setting.get());
    request.metrics = columns.metrics();
    const auto summaries = map::run_map(request, {});
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        const Claim& claim = claims[pictures[k]];
        results[pictures[k]] = judge(claim, columns.value(claim, summaries[rows[k]]), &summaries[rows[k]]);
    }
}

/// The claims about one rendered scene: one run, all stages that they name.
void measure_render(const std::vector<Claim>& claims, const Places& places, const ClaimRequest& run,
                    std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const scene::file::Scene scene = one_scene(first, first.render, run);
    if (!scene.meets(scene::file::rendered_shape))
        scene::toml::fail(first.where, "scene \"" + first.render + "\" has no spheres to render");
    const scene::file::Appearance& look = scene.appearance;
    picture::RenderRequest request{.scene = &scene, .stages = {}, .rows = {}, .limit = {.stop = run.stop}};
    std::set<scene::file::Stage> stages;
    for (const std::size_t i : places) {
        const scene::file::Stage stage = claims[i].stage.value_or(look.furthest());
        if (!look.asks_for(stage))
            scene::toml::fail(claims[i].where,
                              "scene \"" + first.render + "\" has no stage " + std::string(name_of(stage)));
        stages.insert(stage);
        request.rows.push_back(row_for(claims[i], Rendered{}));
    }
    request.stages.assign(stages.begin(), stages.end());
    const auto summaries = picture::run_render(request);
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Claim& claim = claims[places[k]];
        const auto stage =
            std::ranges::find(request.stages, claim.stage.value_or(look.furthest())) - request.stages.begin();
        const picture::RenderSummary& s = summaries[k * request.stages.size() + static_cast<std::size_t>(stage)];
        ClaimResult& result = results[places[k]] =
            judge(claim, picture::render_value(s, claim.metric, claim.where.text()), nullptr);
        if (s.unresolved() == 0) continue;
        result.state = ClaimResult::State::broken;
        result.trouble = std::to_string(s.unresolved()) + " pixels are not proved";
    }
}

}  // namespace lostbits::measure::claim
