// The metrics of one run: rows of the table, and metrics that are made for the run.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

/// Owns the metrics that are not in the table, so it must outlive every request that holds them. Not thread-safe.
class MetricSet {
public:
    /// Finds the metric of that name. `contribution:LABEL`, `cancellation:LABEL`, `tolerance:LENGTH` and
    /// `enough_bits:BITS` make a metric here. Returns null for an unknown name. Throws InputError for a LENGTH that is
    /// not a length, and for a second LENGTH: the columns are called `tolerance` for any length.
    const Metric* find(std::string_view name);

    /// Makes a `culprit` metric whose categories are `none` and these operations.
    const Metric* make_culprit(const std::vector<std::string>& operations);

    /// Adapts the metrics to these forms: the categories of `culprit` are the operations of each form, and an operation
    /// of several forms is listed once. Throws InputError for a label that no form has, with did-you-mean.
    std::vector<const Metric*> adapt_to_forms(std::vector<const Metric*> metrics,
                                              const std::vector<const intersect::table::Intersector*>& forms,
                                              const attribution::Setting& setting);
    /// Like the other overload, but the setting is made only where a metric depends on it: a scene may have millions of
    /// primitives.
    std::vector<const Metric*> adapt_to_forms(std::vector<const Metric*> metrics,
                                              const std::vector<const intersect::table::Intersector*>& forms,
                                              const std::function<attribution::OwnedSetting()>& setting);

private:
    const Metric* make_metric_with_number(const Metric& kind, std::string_view name);

    struct OwnedMetric {
        std::string name, layer, meaning;
        std::vector<std::string> operations;
        std::vector<std::string_view> categories;
        Metric metric;
    };
    std::deque<OwnedMetric> owned_;  // a deque, because pointers to its rows must stay valid
};

}  // namespace lostbits::measure::metric
