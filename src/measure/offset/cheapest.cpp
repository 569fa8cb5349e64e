#include "measure/offset/cheapest.hpp"

#include <algorithm>

namespace lostbits::measure::offset {

std::vector<SafeStrategy> safe_strategies(const OffsetSummary& summary, const std::vector<const Strategy*>& strategies,
                                          Shape shape, std::span<const Side> sides) {
    std::vector<SafeStrategy> safe;
    for (std::size_t k = 0; k < strategies.size() && summary.points > 0; ++k) {
        const auto is_right = [&](Side side) { return summary.on(side).strategies[k].bad == 0; };
        if (!std::ranges::all_of(sides, is_right)) continue;
        double oversize = truth::missing;
        for (const Side side : sides) {
            const double median = summary.on(side).strategies[k].oversize.quantile(0.5);
            if (!(oversize >= median)) oversize = median;
        }
        safe.push_back({strategies[k], strategies[k]->operations(shape), oversize});
    }
    std::ranges::stable_sort(safe, {}, &SafeStrategy::operations);
    return safe;
}

std::vector<SafeStrategy> safe_strategies(const scene::file::Scene& scene, const OffsetRow& row,
                                          std::span<const Side> sides) {
    OffsetRequest request{.scene = &scene, .rows = {row}, .strategies = all_strategies(), .quiet = false};
    return safe_strategies(run_offsets(request).front(), request.strategies, row.row.form->shape, sides);
}

}  // namespace lostbits::measure::offset
