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

std::unique_ptr<lostbits_result> map_result(const lostbits_scene& scene_handle, CallSelection& chosen,
                                            CallSettings& settings) {
    const scene::file::Scene& scene = scene_handle.scene;
    chosen.keep_forms_for("scene " + scene.id, [&](Shapes forms) { return scene.accepts(forms); });
    std::vector<const Metric*> metrics{measure::metric::find_metric("lost_bits")};
    std::ranges::copy(chosen.extra_metrics, std::back_inserter(metrics));
    static_cast<void>(selection::applicable_metrics(metrics, chosen.tested_forms, "scene " + scene.id));
    auto request = study::map_study(scene, chosen.tested_forms, metrics, chosen.metric_set, settings.stop());
    request.progress = settings.advance_callback(scene.pixels() * request.rows.size());

    auto result = std::make_unique<lostbits_result>();
    const auto summary = output::map::summary_table(request.metrics, scene.shapes(), scene.mesh != nullptr);
    ResultTable& table = result->tables.emplace_back("summary", summary.columns());
    std::deque<RayTable> ray_tables;
    for (const TestedForm& tested_form : request.rows) {
        if (chosen.arguments.rows == 0) break;
        ResultTable& ray_table = result->tables.emplace_back(
            std::string(tested_form.form->info->name) + "." + std::string(tested_form.format.name),
            RayTable::columns(request.metrics));
        ray_tables.emplace_back(ray_table, tested_form, request.metrics);
    }
    const auto show = ray_tables.empty() ? measure::evaluate::ShowRows() : measure::evaluate::show_to_each(ray_tables);
    const auto summaries = measure::evaluate::run_map(request, show);
    auto csv = table.writer();
    const auto name_worst_ray = [&](const measure::evaluate::WorstRay& ray) {
        return scene_handle.explain_arguments.empty()
                   ? std::string()
                   : output::attribution::explain_pixel_arguments(scene_handle.explain_arguments,
                                                                  static_cast<int>(ray.x), ray.y);
    };
    for (std::size_t r = 0; r < request.rows.size(); ++r)
        summary.add_row(csv, {request.rows[r], &summaries[r], name_worst_ray});
    result->texts = selection::suspicions_of(request.rows, [&scene](const TestedForm& tested_form) {
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
        return hand_over(map_result(*scene, chosen, settings), result);
    });
}
