// Parts of measuring a row on a band: the columns that it fills, the outcome of every ray, a form's statements about
// its own answer, and the sums for all summaries.
#pragma once

#include <optional>
#include <vector>

#include "measure/answer/mesh_outcomes.hpp"
#include "measure/answer/outcome.hpp"
#include "measure/columns/columns.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/evaluate/measure_form.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::evaluate {

/// Columns of a row on a band. Each thread reuses its own: allocating a megabyte each time takes longer than filling
/// it.
struct RowColumns {
    std::vector<answer::Outcome> outcomes;
    std::vector<std::vector<double>> metrics;
    std::vector<double> correct_t, spare_ulps;

    /// Makes columns for n rays. Metrics that are computed ray by ray, not as a column, start with NaN for every ray.
    void make(std::size_t n, const std::vector<const metric::Metric*>& wanted) {
        outcomes.resize(n);
        metrics.resize(wanted.size());
        for (std::size_t m = 0; m < wanted.size(); ++m) {
            if (wanted[m]->column_kernel == metric::ColumnKernel::none) metrics[m].assign(n, truth::missing);
            else metrics[m].resize(n);
        }
    }
};

/// Outputs for the outcomes of a band, with an element for each ray.
struct OutcomeColumns {
    std::vector<answer::Outcome>& outcomes;
    std::vector<double>& correct_t;  ///< the form's t at correct hits, NaN elsewhere
};

/// Finds the outcome of every ray, and counts the outcomes in `summary`. `returns_t` is false for a form that answers
/// only hit or miss: its hits have no t, which does not count as NaN, and the primitive that they hit is unknown.
void find_outcomes(const answer::BandAnswers& band_answers, const columns::TrueLengths& truth, bool returns_t,
                   const OutcomeColumns& out, FormSummary& summary);

/// A form's statements about its own answer to ray i at one primitive: its error bound, the arithmetic of its filter,
/// its steps, the levels of its boxes. The levels are those for the primitive `true_primitive`, which the ray truly
/// meets; if it is negative, the ray misses, and there are no levels. Statements that `needs` does not name, or that
/// the form cannot make, are empty.
class FormStatements {
public:
    FormStatements(const TestedForm& tested_form, unsigned needs, const truth::FormatInputs& inputs,
                   const Ray<double>& ray, std::size_t i, std::size_t primitive, std::int32_t true_primitive);
    /// Sets pointers in the sample to this object, which must outlive the sample.
    void fill(metric::Sample& sample) const;

private:
    std::optional<intersect::BoundedAnswer> bounded_;
    std::optional<intersect::DecidingArithmetic> deciding_arithmetic_;
    std::optional<answer::Steps> steps_;
    std::optional<answer::Levels> levels_;
    double end_margin_ = truth::missing;
};

/// Adds the results of a row on a band to summaries. The request, result and columns must outlive the RowSums.
class RowSums {
public:
    /// `ulps`: the ulp_error of each ray, NaN for all but correct hits.
    RowSums(const FormRequest& request, const BandResult& result, const columns::TrueLengths& truth, const double* ulps)
        : request_(request), row_(request.tested_form), result_(result), truth_(truth), ulps_(ulps) {}

    /// Keeps the first of the rays with the largest error; `largest` is the largest |ulps|.
    void keep_worst(FormSummary& summary, double largest) const;
    /// Keeps the first ray of each wrong decision.
    void keep_faults(FormSummary& summary) const;
    /// Adds the rays of a subset to the summary of the subset.
    void add(const RaySubset& part) const;

private:
    /// Ray i with all its inputs, for a summary.
    [[nodiscard]] WorstRay ray_with_inputs(std::size_t i, answer::Outcome outcome) const;
    [[nodiscard]] WorstRay worst_hit(std::size_t i) const;

    const FormRequest& request_;
    const TestedForm& row_;
    const BandResult& result_;
    const columns::TrueLengths& truth_;
    const double* ulps_;
};

}  // namespace lostbits::measure::evaluate
