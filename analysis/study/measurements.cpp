#include "analysis/study/measurements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "measure/attribution/culprits.hpp"
#include "measure/evaluate/culprit_order.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis::study {

using measure::attribution::OwnedSetting;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

measure::evaluate::MapStudy map_study(const scene::file::Scene& scene, std::vector<TestedForm> tested_forms,
                                      const std::vector<const Metric*>& metrics, measure::metric::MetricSet& metric_set,
                                      intersect::process::StopToken stop) {
    measure::evaluate::MapStudy map{
        .scene = &scene, .tested_forms = std::move(tested_forms), .metrics = {}, .limit = {.stop = stop}};
    map.metrics = metric_set.adapt_to_forms(selection::with_default_metrics(metrics, map.tested_forms),
                                            measure::evaluate::forms_of(map.tested_forms),
                                            [&scene] { return OwnedSetting(scene); });
    map.metrics = measure::evaluate::order_culprits(map, metric_set);
    return map;
}

measure::sweep::SweepRequest sweep_request(const scene::sweep::SweepFile& sweep, std::vector<TestedForm> tested_forms,
                                           std::vector<const Metric*> metrics, measure::metric::MetricSet& metric_set,
                                           intersect::process::StopToken stop) {
    measure::sweep::SweepRequest request{
        .sweep = sweep, .tested_forms = std::move(tested_forms), .metrics = {}, .limit = {.stop = stop}};
    // Forms that march stop short on purpose, so the error alone says little: it is split in two.
    if (std::ranges::any_of(request.tested_forms,
                            [](const TestedForm& tested_form) { return !is_primitive(tested_form.form->shape); })) {
        for (const char* name : {"model_error", "rounding_error"})
            metrics.push_back(measure::metric::find_metric(name));
    }
    request.metrics = metric_set.adapt_to_forms(selection::with_default_metrics(metrics, request.tested_forms),
                                                measure::evaluate::forms_of(request.tested_forms),
                                                [&sweep] { return OwnedSetting(sweep.first_rays()); });
    for (TestedForm& tested_form : request.tested_forms) tested_form.touching = sweep.convention;
    request.further_draw_count = 2;
    request.recoveries = request.both_ends = true;
    return request;
}

namespace {

constexpr std::string_view default_shape = "sphere";

std::vector<TestedForm> select_forms_of_shape(const std::string& given_name, const std::vector<TestedForm>& selected) {
    const std::string shape_name = given_name.empty() ? std::string(default_shape) : given_name;
    const auto parsed = shape_named(shape_name);
    if (!parsed || !is_primitive(*parsed)) {
        std::vector<std::string> names;
        for (const ShapeRow& shape_row : shape_rows) names.emplace_back(shape_row.name);
        throw InputError(fmt::format("shape \"{}\" is unknown; {}", shape_name, text::did_you_mean(shape_name, names)));
    }

    const Shape shape = *parsed;
    const auto tested_forms =
        selection::filter_tested_forms(selected, [shape](Shapes forms) { return forms == shape; });
    if (!tested_forms.empty()) return tested_forms;

    // Says why none of the forms fits.
    if (!selection::filter_tested_forms(selected, [shape](Shapes forms) {
             return forms == Shapes(shape).with_transform();
         }).empty())
        throw NothingSelected(
            fmt::format("--shape {}: its primitive has no transform, so FORM@TRANSFORM makes no sense here; name "
                        "a scene with matrices, as in `lostbits trade instance-far.{}`",
                        shape_name, shape_name));
    if (given_name.empty())
        throw NothingSelected(fmt::format(
            "no selected form is for a {0}, the default shape; name the shape of the forms, as in --shape box, or "
            "choose forms by -i '{0}.*'",
            shape_name));
    throw NothingSelected(fmt::format("--shape {0}: no selected form is for {1}; try -i '{0}.*' or another --shape",
                                      shape_name, with_article(shape)));
}

void require_timeable(const std::vector<TestedForm>& tested_forms) {
    const auto emulated = std::ranges::find_if(
        tested_forms, [](const TestedForm& tested_form) { return tested_form.format.is_emulated(); });
    if (emulated != tested_forms.end())
        throw InputError(fmt::format("-f {}: this format is emulated, so its time says nothing; name f32 or f64",
                                     emulated->format.name));
    selection::require_no_generators(tested_forms, "trade");
    selection::require_no_contracted_forms(tested_forms, "trade");
}

}  // namespace

std::vector<TestedForm> with_each_convention(const scene::sweep::CaseFile& file,
                                             const std::vector<TestedForm>& tested_forms) {
    std::vector<TestedForm> judged_forms;
    for (TestedForm tested_form : tested_forms) {
        for (const auto& convention : file.conventions) {
            tested_form.touching = convention;
            judged_forms.push_back(tested_form);
        }
    }
    return judged_forms;
}

measure::trade::TradeRequest trade_request(const scene::file::Scene* scene, const std::string& shape,
                                           const selection::SelectedForms& selected) {
    require_timeable(selected.tested_forms);
    const auto tested_forms =
        scene ? selection::select_timed_forms(*scene, selected) : select_forms_of_shape(shape, selected.tested_forms);
    return {.shape = tested_forms.front().form->shape,
            .scene = scene,
            .kernels = measure::trade::make_trade_kernels(tested_forms),
            .metrics = {measure::metric::find_metric("lost_bits"), measure::metric::find_metric("excess_bits")},
            .loads = scene ? measure::trade::make_scene_load()
                           : measure::trade::make_trade_loads(measure::trade::read_cache_sizes())};
}

measure::trade::TimingPlan quick_plan() {
    measure::trade::TimingPlan plan;
    plan.repetitions = 5;
    plan.min_seconds = 1e-4;
    return plan;
}

}  // namespace lostbits::analysis::study
