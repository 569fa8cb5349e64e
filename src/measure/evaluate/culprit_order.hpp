// Culprits of a picture, most frequent first: their colours follow this order.
#pragma once

#include "measure/evaluate/map.hpp"
#include "measure/metric/metric_set.hpp"

namespace lostbits::measure::evaluate {

/// The same view with fewer rays: at most `max_across` in the longer direction.
scene::file::Scene small_picture_of(const scene::file::Scene& scene, int max_across);

/// The study's metrics, with the categories of `culprit` sorted by how often they are to blame. The counts are over all
/// tested forms on a small picture of the scene (at most 96 rays across). Categories that do not occur there come last,
/// in the order of the tapes. The result is the same for any number of threads.
std::vector<const metric::Metric*> order_culprits(const MapStudy& study, metric::MetricSet& metric_set);

}  // namespace lostbits::measure::evaluate
