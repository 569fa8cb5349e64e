// The culprits of a picture, most frequent first: colours go by their place.
#pragma once

#include "measure/evaluate/evaluate.hpp"
#include "measure/metric/metric_set.hpp"

namespace lostbits::measure::evaluate {

/// The same view in fewer rays: at most so many across.
scene::file::Scene small_picture_of(const scene::file::Scene& scene, int most_across);

/// The request's metrics with the categories of `culprit` in the order of how often they are to blame over all rows of
/// a small picture of the scene (at most 96 rays across); what does not occur there comes after, in the order of the
/// tapes. The same for any number of threads.
std::vector<const metric::Metric*> order_culprits(const EvaluationRequest& request, metric::MetricSet& made);

}  // namespace lostbits::measure::evaluate
