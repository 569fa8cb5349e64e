#include "measure/evaluate/culprit_order.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace lostbits::measure::evaluate {

using metric::Metric;
using scene::file::Scene;

Scene small_picture_of(const Scene& scene, int max_across) {
    Scene small = scene;
    const int across = std::max(scene.width, scene.height);
    if (across <= max_across) return small;
    small.width = std::max(1, scene.width * max_across / across);
    small.height = std::max(1, scene.height * max_across / across);
    return small;
}

std::vector<const Metric*> order_culprits(const MapStudy& study, metric::MetricSet& metric_set) {
    const auto culprit = std::ranges::find_if(study.metrics, &Metric::depends_on_forms);
    if (culprit == study.metrics.end()) return study.metrics;

    // Counts the culprits of all rows on a small picture.
    const Scene small = small_picture_of(*study.scene, 96);
    const auto summaries =
        run_map({.scene = &small, .tested_forms = study.tested_forms, .metrics = {*culprit}, .limit = study.limit});
    const auto categories = (*culprit)->categories;
    std::vector<std::uint64_t> total(categories.size());
    for (const FormSummary& summary : summaries)
        std::ranges::transform(total, summary.categories.front(), total.begin(), std::plus{});

    // Puts the most frequent first.
    std::vector<std::size_t> order(total.size() - 1);  // without `none`, which stays in front
    std::iota(order.begin(), order.end(), std::size_t{1});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return total[a] > total[b]; });
    std::vector<std::string> operations;
    for (const std::size_t category : order) operations.emplace_back(categories[category]);
    std::vector<const Metric*> metrics = study.metrics;
    std::ranges::replace(metrics, *culprit, metric_set.make_culprit(operations));
    return metrics;
}

}  // namespace lostbits::measure::evaluate
