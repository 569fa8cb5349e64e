// What a row found on a band, as summaries take it up.
#pragma once

#include "measure/columns/columns.hpp"
#include "measure/evaluate/measure_row.hpp"

namespace lostbits::measure::evaluate {

/// Looks at what is measured, and outlives none of it.
class RowSums {
public:
    /// `ulps`: the ulp_error of each ray, NaN of all but correct hits.
    RowSums(const RowRequest& request, const BandResult& result, const columns::TrueLengths& truth, const double* ulps)
        : request_(request), row_(request.row), result_(result), truth_(truth), ulps_(ulps) {}

    /// The first of the rays that are farthest off; `largest` is the largest |ulps|.
    void keep_worst(FormSummary& summary, double largest) const;
    /// The first ray of each wrong decision.
    void keep_faults(FormSummary& summary) const;
    /// All that a summary has, of some rays.
    void add(const BandPart& part) const;

private:
    /// Ray i as a summary names it.
    [[nodiscard]] WorstRay named(std::size_t i, answer::Outcome outcome) const;
    [[nodiscard]] WorstRay worst(std::size_t i) const;

    const RowRequest& request_;
    const TestedForm& row_;
    const BandResult& result_;
    const columns::TrueLengths& truth_;
    const double* ulps_;
};

}  // namespace lostbits::measure::evaluate
