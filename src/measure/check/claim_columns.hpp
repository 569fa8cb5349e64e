// Finds the number that a claim is about: a column of a summary by its name, or the share of culprits.
#pragma once

#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/metric/metric_set.hpp"
#include "scene/check/claims_file.hpp"

namespace lostbits::measure::check {

/// True if a claim is about culprits, cancellation or contributions: such claims need the tape of every ray.
bool asks_for_attribution(const scene::check::Claim& claim);

/// Columns of summaries that the claims about one subject name.
class ClaimColumns {
public:
    /// Throws InputError, with the position of the claim, if a claim names an operation or label that its form does not
    /// have. The setting must outlive this object.
    ClaimColumns(const std::vector<const scene::check::Claim*>& claims,
                 const std::vector<evaluate::TestedForm>& tested_forms, const attribution::Setting& setting);

    /// Metrics to measure: the default metrics, and those whose columns a claim names. Other metrics are left out,
    /// since some need an exact evaluation of every form.
    [[nodiscard]] const std::vector<const metric::Metric*>& metrics() const { return metrics_; }
    /// Value of the claim's column in a summary of `metrics()`; NaN if the column has no value. Throws InputError for
    /// an unknown name, with did-you-mean.
    [[nodiscard]] double value(const scene::check::Claim& claim, const evaluate::FormSummary& summary) const;

private:
    void add_metric_of_label(const scene::check::Claim& claim);
    [[nodiscard]] double culprit_fraction(const scene::check::Claim& claim, const evaluate::FormSummary& summary) const;

    attribution::Setting setting_;
    metric::MetricSet metric_set_;
    std::vector<const metric::Metric*> metrics_;
};

}  // namespace lostbits::measure::check
