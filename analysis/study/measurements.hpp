// The measurements of a scene, of a sweep along axes and of speed. The program and the library make them in the same
// way.
#pragma once

#include <string>
#include <vector>

#include "analysis/selection/select.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/metric/metric_set.hpp"
#include "measure/sweep/sweep.hpp"
#include "measure/trade/trade.hpp"

namespace lostbits::analysis::study {

/// The map of a scene with the given metrics and the default metrics of a map, as far as these apply to the forms.
/// `metric_set` owns the metrics that are made for the map. The scene must outlive the result.
measure::evaluate::MapStudy map_study(const scene::file::Scene& scene,
                                      std::vector<measure::evaluate::TestedForm> tested_forms,
                                      const std::vector<const measure::metric::Metric*>& metrics,
                                      measure::metric::MetricSet& metric_set, intersect::process::StopToken stop);

/// The request of a sweep along axes, with the metrics as in `map_study`. It is judged by the convention of the sweep's
/// file, and has three draws of random rays for the spread of onsets. The sweep must outlive the result.
measure::sweep::SweepRequest sweep_request(const scene::sweep::SweepFile& sweep,
                                           std::vector<measure::evaluate::TestedForm> tested_forms,
                                           std::vector<const measure::metric::Metric*> metrics,
                                           measure::metric::MetricSet& metric_set, intersect::process::StopToken stop);

/// Each form once for every convention of a file of cases, by which it is judged.
std::vector<measure::evaluate::TestedForm> with_each_convention(
    const scene::sweep::CaseFile& file, const std::vector<measure::evaluate::TestedForm>& tested_forms);

/// The speed and accuracy of forms: on the rays of a scene or, if it is null, on rays of known kinds at a shape (empty:
/// sphere). Throws InputError for forms that cannot be timed, and NothingSelected if none fits. The scene must outlive
/// the result.
measure::trade::TradeRequest trade_request(const scene::file::Scene* scene, const std::string& shape,
                                           const selection::SelectedForms& selected);

/// Few and short measurements, for a first look.
measure::trade::TimingPlan quick_plan();

}  // namespace lostbits::analysis::study
