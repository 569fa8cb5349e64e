// Maps of a scene.
#include "analysis/library/handles.hpp"
#include "analysis/study/measurements.hpp"
#include "measure/contract/suspect.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::analysis::library {

using measure::evaluate::TestedForm;
using measure::metric::Metric;

namespace {

std::unique_ptr<lostbits_result> make_map_result(const lostbits_scene& scene_handle, CallSelection& chosen,
                                                 CallSettings& settings) {
    const scene::file::Scene& scene = scene_handle.scene;
    chosen.keep_forms_for("scene " + scene.id, [&](Shapes forms) { return scene.accepts(forms); });
    std::vector<const Metric*> metrics{measure::metric::find_metric("lost_bits")};
    std::ranges::copy(chosen.extra_metrics, std::back_inserter(metrics));
    static_cast<void>(selection::applicable_metrics(metrics, chosen.tested_forms, "scene " + scene.id));
    auto request = study::map_study(scene, chosen.tested_forms, metrics, chosen.metric_set, settings.stop());
    request.progress = settings.advance_callback(scene.pixels() * request.tested_forms.size());

    auto result = std::make_unique<lostbits_result>();
    const auto summary = output::map::summary_table(request.metrics, scene.shapes(), scene.mesh != nullptr);
    ResultTable& table = result->tables.emplace_back("summary", summary.columns());

    // The tables with a row per ray are filled while the map is measured.
    std::deque<RayTable> ray_tables = add_ray_tables(*result, chosen, request.tested_forms, request.metrics);
    const auto show = ray_tables.empty() ? measure::evaluate::ShowForms() : measure::evaluate::show_to_each(ray_tables);
    const auto summaries = measure::evaluate::run_map(request, show);

    auto csv = table.writer();
    const auto name_worst_ray = [&](const measure::evaluate::WorstRay& ray) {
        return scene_handle.explain_arguments.empty()
                   ? std::string()
                   : output::attribution::explain_pixel_arguments(scene_handle.explain_arguments,
                                                                  static_cast<int>(ray.x), ray.y);
    };
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r)
        summary.add_row(csv, {request.tested_forms[r], &summaries[r], name_worst_ray});
    result->texts = selection::list_suspicions(request.tested_forms, [&scene](const TestedForm& tested_form) {
        return measure::contract::suspicion_text(scene, tested_form);
    });
    return result;
}

}  // namespace
}  // namespace lostbits::analysis::library

using namespace lostbits;
using namespace lostbits::analysis::library;

extern "C" int lostbits_map(const lostbits_scene* scene, const lostbits_choice* choice, const lostbits_run* run,
                            lostbits_result** result, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(scene, "scene");
        require(result, "result");
        CallSelection chosen(choice);
        CallSettings settings(run);
        return hand_over(make_map_result(*scene, chosen, settings), result);
    });
}
