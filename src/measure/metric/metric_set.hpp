// The metrics of one run: rows of the table, and those that are made for it.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

/// Keeps the rows that are in no table: it outlives every request that holds them. Not for several threads at once.
class MetricSet {
public:
    /// The metric of that name; of `contribution:LABEL`, `cancellation:LABEL`, `tolerance:LENGTH` and
    /// `enough_bits:BITS` one that is made here. Null where no metric is called so. InputError for a LENGTH that is
    /// none, and for a second one: columns are called `tolerance`, whatever the length.
    const Metric* find(std::string_view name);

    /// `culprit` that tells these operations apart: its categories are `none`, then these.
    const Metric* culprit_of(const std::vector<std::string>& operations);

    /// The metrics as these forms have them: the categories of `culprit` are the operations of each form, those that
    /// several forms share once. InputError for a label that no form has, with did-you-mean.
    std::vector<const Metric*> for_forms(std::vector<const Metric*> metrics,
                                         const std::vector<const intersect::table::Intersector*>& forms,
                                         const blame::Setting& setting);
    /// The same in a setting that is made only where a metric depends on it: a scene may have millions of solids.
    std::vector<const Metric*> for_forms(std::vector<const Metric*> metrics,
                                         const std::vector<const intersect::table::Intersector*>& forms,
                                         const std::function<blame::SettingOf()>& setting);

private:
    const Metric* of_number(const Metric& kind, std::string_view name);

    struct Made {
        std::string name, layer, meaning;
        std::vector<std::string> operations;
        std::vector<std::string_view> categories;
        Metric row;
    };
    std::deque<Made> made_;  // rows stay where they are
};

}  // namespace lostbits::measure::metric
