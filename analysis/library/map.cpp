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

std::unique_ptr<lostbits_result> make_map_result(const lostbits_scene& scene_handle, CallSelection& call_selection,
                                                 CallSettings& settings) {
    const scene::file::Scene& scene = scene_handle.scene;
    call_selection.keep_forms_for("scene " + scene.id, [&](Shapes forms) { return scene.accepts(forms); });
    std::vector<const Metric*> metrics{measure::metric::find_metric("lost_bits")};
    std::ranges::copy(call_selection.extra_metrics, std::back_inserter(metrics));
    selection::require_applicable_metrics(metrics, call_selection.tested_forms, "scene " + scene.id);
    auto study =
        study::map_study(scene, call_selection.tested_forms, metrics, call_selection.metric_set, settings.stop());
    study.progress = settings.advance_callback(scene.pixel_count() * study.tested_forms.size());

    auto result = std::make_unique<lostbits_result>();
    const auto summary = output::map::make_summary_table(study.metrics, scene.shapes(), scene.mesh != nullptr);
    ResultTable& table = result->tables.emplace_back("summary", summary.columns());

    // The tables with a row per ray are filled while the map is measured.
    std::deque<RayTable> ray_tables = add_ray_tables(*result, call_selection, study.tested_forms, study.metrics);
    const auto show = ray_tables.empty() ? measure::evaluate::ShowForms() : measure::evaluate::show_to_each(ray_tables);
    const auto summaries = measure::evaluate::run_map(study, show);

    auto rows = table.writer();
    const auto explain_arguments_of = [&](const measure::evaluate::WorstRay& ray) {
        return scene_handle.explain_arguments.empty()
                   ? std::string()
                   : output::attribution::explain_pixel_arguments(scene_handle.explain_arguments,
                                                                  static_cast<int>(ray.x), ray.y);
    };
    for (std::size_t form_index = 0; form_index < study.tested_forms.size(); ++form_index)
        summary.add_row(rows, {study.tested_forms[form_index], &summaries[form_index], explain_arguments_of});
    result->texts = selection::list_suspicions(study.tested_forms, [&scene](const TestedForm& tested_form) {
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
        CallSelection call_selection(choice);
        CallSettings settings(run);
        return hand_over(make_map_result(*scene, call_selection, settings), result);
    });
}
