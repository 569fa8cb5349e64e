#include "measure/map/culprit_order.hpp"

#include <algorithm>
#include <deque>
#include <mutex>
#include <numeric>

#include "measure/blame/culprits.hpp"

namespace lostbits::measure::map {

using metric::Metric;
using scene::file::Scene;

namespace {

constexpr int most_across = 96;

Scene small_picture_of(const Scene& scene) {
    Scene small = scene;
    const int across = std::max(scene.width, scene.height);
    if (across <= most_across) return small;
    small.width = std::max(1, scene.width * most_across / across);
    small.height = std::max(1, scene.height * most_across / across);
    return small;
}

/// Lives as long as the program, as `culprit_among` does.
const Metric* reordered(const Metric& culprit, const std::vector<std::size_t>& order) {
    static std::mutex lock;
    static std::deque<std::vector<std::string_view>> lists;
    static std::deque<Metric> rows;
    const std::lock_guard guard(lock);
    auto& list = lists.emplace_back();
    for (const std::size_t place : order) list.push_back(culprit.categories[place]);
    Metric row = culprit;
    row.categories = list;
    return &rows.emplace_back(row);
}

}  // namespace

void order_culprits(MapRequest& request) {
    const auto culprit = std::ranges::find_if(request.metrics, &Metric::by_run);
    if (culprit == request.metrics.end()) return;
    const Scene small = small_picture_of(*request.scene);
    const auto summaries =
        run_map({.scene = &small, .rows = request.rows, .metrics = {*culprit}, .limit = request.limit}, {});
    std::vector<std::uint64_t> total((*culprit)->categories.size());
    for (const MapSummary& s : summaries)
        std::ranges::transform(total, s.categories.front(), total.begin(), std::plus{});
    std::vector<std::size_t> order(total.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin() + 1, order.end(),
                     [&](std::size_t a, std::size_t b) { return total[a] > total[b]; });  // `none` stays in front
    *culprit = reordered(**culprit, order);
}

}  // namespace lostbits::measure::map
