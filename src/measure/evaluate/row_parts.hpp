// What measuring a row on a band is made of: the columns that it fills, the outcome of every ray, what a form says of
// its own answer, and what of it all summaries take up.
#pragma once

#include <optional>
#include <vector>

#include "measure/answer/mesh_outcomes.hpp"
#include "measure/answer/outcome.hpp"
#include "measure/columns/columns.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/evaluate/measure_row.hpp"
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

/// Where the outcomes of a band go: as many of each as rays.
struct OutcomeColumns {
    std::vector<answer::Outcome>& outcomes;
    std::vector<double>& measured;  ///< the answers of the correct hits, NaN elsewhere
};

/// The outcome of every ray, counted in `summary` too. A form that does not tell t claims no hit at NaN, and on which
/// solid it hits nobody knows.
void find_outcomes(const answer::BandAnswers& of, const columns::TrueLengths& truth, bool tells_t,
                   const OutcomeColumns& out, FormSummary& summary);

/// Of ray i and one solid; of the levels of a hierarchy, of the one that is truly met, nothing where `truly` is below
/// 0. Empty of what `needs` does not name or the form cannot tell.
class OwnWords {
public:
    OwnWords(const TestedForm& row, unsigned needs, const truth::FormatInputs& inputs, const Ray<double>& ray,
             std::size_t i, std::size_t solid, std::int32_t truly);
    /// Points the sample to this, which must outlive it.
    void into(metric::Sample& sample) const;

private:
    std::optional<intersect::BoundedAnswer> bounded_;
    std::optional<intersect::Way> way_;
    std::optional<answer::Steps> steps_;
    std::optional<answer::Levels> levels_;
    double end_margin_ = truth::missing;
};

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
