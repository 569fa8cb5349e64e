#include "output/map/culprit_table.hpp"

#include <algorithm>
#include <array>

#include "measure/blame/culprits.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::map {

using measure::metric::Metric;

std::vector<std::size_t> culprits_by_count(const std::vector<std::uint64_t>& counts) {
    std::vector<std::size_t> order;
    for (std::size_t c = 1; c < counts.size(); ++c) {
        if (counts[c] > 0) order.push_back(c);
    }
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
    return order;
}

table::Table<Culprit> culprit_table() {
    using R = Culprit;
    table::Table<R> table;
    table.add(table::subject_columns(), &R::row);
    table.add({{"operation", "string", "",
                "what the form computes there; one axis stands for all three, and one round of a loop for every round",
                &R::operation},
               {"culprit_rays", "integer", "", "rays whose culprit it is: correct hits, false hits and false misses",
                &R::rays},
               {"culprit_fraction", "number", "1", "their share of the rays that have a culprit", &R::fraction}});
    return table;
}

bool asks_for_culprits(const std::vector<const Metric*>& metrics) {
    return std::ranges::any_of(metrics, &Metric::by_run);
}

std::vector<Culprit> culprits_of(const std::vector<const Metric*>& metrics, const measure::evaluate::TestedForm& row,
                                 const measure::evaluate::FormSummary& summary) {
    const auto metric = std::ranges::find_if(metrics, &Metric::by_run);
    const auto& counts = summary.categories[static_cast<std::size_t>(metric - metrics.begin())];
    std::vector<Culprit> culprits;
    for (const std::size_t c : culprits_by_count(counts))
        culprits.push_back(
            {row, (*metric)->categories[c], counts[c], measure::blame::culprit_share(counts, std::array{c})});
    return culprits;
}

}  // namespace lostbits::output::map
