#include "output/map/culprit_table.hpp"

#include <algorithm>
#include <array>

#include "measure/blame/culprits.hpp"

namespace lostbits::output::map {

using file::Column;
using measure::metric::Metric;

std::vector<std::size_t> culprits_by_count(const std::vector<std::uint64_t>& counts) {
    std::vector<std::size_t> order;
    for (std::size_t c = 1; c < counts.size(); ++c) {
        if (counts[c] > 0) order.push_back(c);
    }
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
    return order;
}

std::vector<Column> CulpritTable::columns(std::vector<Column> before) {
    before.push_back({"form", "string", "", "form under test"});
    before.push_back({"format", "string", "", "format it computes in"});
    before.push_back(
        {"operation", "string", "",
         "what the form computes there; one axis stands for all three, and one round of a loop for every round"});
    before.push_back(
        {"culprit_rays", "integer", "", "rays whose culprit it is: correct hits, false hits and false misses"});
    before.push_back({"culprit_fraction", "number", "1", "their share of the rays that have a culprit"});
    return before;
}

bool CulpritTable::is_wanted(const std::vector<const Metric*>& metrics) {
    return std::ranges::any_of(metrics, &Metric::by_run);
}

CulpritTable::CulpritTable(const std::filesystem::path& path, const std::vector<Column>& before,
                           const std::vector<const Metric*>& metrics)
    : csv_(path, columns(before)),
      place_(static_cast<std::size_t>(std::ranges::find_if(metrics, &Metric::by_run) - metrics.begin())),
      categories_(metrics.at(place_)->categories) {}

void CulpritTable::add(const measure::map::MapRow& row, const measure::map::MapSummary& summary,
                       const std::function<void(file::CsvWriter&)>& put) {
    const auto& counts = summary.categories[place_];
    for (const std::size_t c : culprits_by_count(counts)) {
        put(csv_);
        csv_.add(row.form->info->name)
            .add(row.format.name)
            .add(categories_[c])
            .add(counts[c])
            .add(measure::blame::culprit_share(counts, std::array{c}));
        csv_.end_row();
    }
}

}  // namespace lostbits::output::map
