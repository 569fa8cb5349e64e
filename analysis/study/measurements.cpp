#include "analysis/study/measurements.hpp"

#include <algorithm>
#include <utility>

#include "analysis/selection/select.hpp"
#include "measure/attribution/culprits.hpp"
#include "measure/evaluate/culprit_order.hpp"

namespace lostbits::analysis::study {

using measure::attribution::OwnedSetting;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

measure::evaluate::MapStudy map_of(const scene::file::Scene& scene, std::vector<TestedForm> rows,
                                   const std::vector<const Metric*>& asked, measure::metric::MetricSet& metric_set,
                                   intersect::process::StopToken stop) {
    measure::evaluate::MapStudy map{.scene = &scene, .rows = std::move(rows), .metrics = {}, .limit = {.stop = stop}};
    map.metrics = metric_set.for_forms(selection::measured(asked, map.rows), measure::evaluate::forms_of(map.rows),
                                       [&scene] { return OwnedSetting(scene); });
    map.metrics = measure::evaluate::order_culprits(map, metric_set);
    return map;
}

measure::sweep::SweepRequest sweep_of(const scene::sweep::SweepFile& sweep, std::vector<TestedForm> rows,
                                      std::vector<const Metric*> asked, measure::metric::MetricSet& metric_set,
                                      intersect::process::StopToken stop) {
    measure::sweep::SweepRequest request{
        .sweep = sweep, .rows = std::move(rows), .metrics = {}, .limit = {.stop = stop}};
    // Forms that march stop short on purpose, so the error alone says little: it is split in two.
    if (std::ranges::any_of(request.rows, [](const TestedForm& row) { return !is_primitive(row.form->shape); })) {
        for (const char* name : {"model_error", "rounding_error"}) asked.push_back(measure::metric::find_metric(name));
    }
    request.metrics =
        metric_set.for_forms(selection::measured(asked, request.rows), measure::evaluate::forms_of(request.rows),
                             [&sweep] { return OwnedSetting(sweep.first_rays()); });
    for (TestedForm& row : request.rows) row.judged = sweep.convention;
    request.further_draws = 2;
    request.recoveries = request.both_ends = true;
    return request;
}

}  // namespace lostbits::analysis::study
