// The columns that a row fills on a band.
#pragma once

#include <vector>

#include "measure/answer/outcome.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::evaluate {

/// What a row takes on a band, kept by the thread: asking for a megabyte anew each time costs more than to fill it.
struct RowColumns {
    std::vector<answer::Outcome> outcomes;
    std::vector<std::vector<double>> metrics;
    std::vector<double> measured, own_ulps;

    /// For n rays; NaN wherever no column fills it.
    void make(std::size_t n, const std::vector<const metric::Metric*>& wanted) {
        outcomes.resize(n);
        metrics.resize(wanted.size());
        for (std::size_t m = 0; m < wanted.size(); ++m) {
            if (wanted[m]->in_columns == metric::InColumns::no) metrics[m].assign(n, truth::missing);
            else metrics[m].resize(n);
        }
    }
};

}  // namespace lostbits::measure::evaluate
