#include "measure/check/claim_columns.hpp"

#include <algorithm>

#include "measure/check/claim.hpp"
#include "measure/evaluate/summary_columns.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::measure::check {

using evaluate::FormSummary;
using evaluate::SummaryColumn;
using metric::Metric;
using scene::check::Claim;

namespace {

/// Columns of a summary that hold numbers. A claim about culprits names operations instead (`culprits`).
std::vector<SummaryColumn> number_columns(const std::vector<const Metric*>& metrics) {
    auto columns = evaluate::make_summary_columns(metrics);
    std::erase_if(columns, [](const SummaryColumn& column) {
        return column.kind == SummaryColumn::Kind::category || column.name == "culprit_fraction";
    });
    std::ranges::sort(columns, {}, &SummaryColumn::name);
    return columns;
}

/// Adds the names of all other columns that a claim may have meant, for did-you-mean.
void add_other_columns(std::vector<std::string>& names) {
    for (const Metric& m : metric::metrics()) {
        if (m.depends_on_forms) names.emplace_back("culprit_fraction");
        else if (m.categories.empty())
            for (const metric::Statistic& statistic : metric::statistics)
                names.push_back(evaluate::column_name(m, statistic));
    }
}

/// Name of an operation in the formula: `c` for `c = dot(o - centre, o - centre) - radius*radius`. Empty if the
/// operation has no name.
std::string label_of_operation(const std::string& operation) {
    const auto equals = operation.find(" = ");
    return equals == std::string::npos ? "" : operation.substr(0, equals);
}

/// Finds the operations of a form that `text` names: the operation with that expression, or the operations with that
/// label. Throws InputError with did-you-mean if the form has no such operation.
std::vector<std::string> find_operations(const std::string& text, const Claim& claim,
                                         const attribution::Setting& setting) {
    const auto operations = attribution::operation_names(*tested_form_of(claim).form, setting);
    std::vector<std::string> matches, known_names;
    for (const std::string& operation : operations) {
        const std::string label = label_of_operation(operation);
        if (operation == text || (!label.empty() && label == text)) matches.push_back(operation);
        if (!label.empty()) known_names.push_back(label);
    }
    if (!matches.empty()) return matches;
    known_names.insert(known_names.end(), operations.begin(), operations.end());
    scene::toml::fail(claim.quantity,
                      claim.form + " has no operation \"" + text + "\"; " + text::did_you_mean(text, known_names));
}

}  // namespace

bool asks_for_attribution(const Claim& claim) {
    return std::ranges::any_of(std::initializer_list<const char*>{"culprit_", "cancellation", "contribution"},
                               [&](const char* prefix) { return claim.metric.starts_with(prefix); });
}

ClaimColumns::ClaimColumns(const std::vector<const Claim*>& claims,
                           const std::vector<evaluate::TestedForm>& tested_forms, const attribution::Setting& setting)
    : setting_(setting) {
    for (const Metric& metric : lostbits::measure::metric::metrics()) {
        const bool is_named = std::ranges::any_of(
            claims, [&](const Claim* c) { return c->metric.starts_with(std::string(metric.name) + "_"); });
        if (metric.is_default || is_named) metrics_.push_back(&metric);
    }
    for (const Claim* claim : claims) {
        for (const std::string& text : claim->operations) find_operations(text, *claim, setting_);  // throws early
        add_metric_of_label(*claim);
    }
    metrics_ = metric_set_.adapt_to_forms(std::move(metrics_), evaluate::forms_of(tested_forms), setting_);
}

/// Adds the metric of `contribution_c_p50` or `cancellation_disc_max`, for a label of the claim's form.
void ClaimColumns::add_metric_of_label(const Claim& claim) {
    std::vector<std::string> names;
    for (const char* kind : {"contribution", "cancellation"}) {
        if (!claim.metric.starts_with(kind)) continue;
        for (const std::string_view label : attribution::labels_of(*tested_form_of(claim).form, setting_)) {
            const Metric* const metric = metric_set_.find(std::string(kind) + ":" + std::string(label));

            for (const metric::Statistic& statistic : metric::statistics) {
                names.push_back(evaluate::column_name(*metric, statistic));
                if (names.back() != claim.metric) continue;
                if (std::ranges::find(metrics_, metric) == metrics_.end()) metrics_.push_back(metric);
                return;
            }
        }
    }

    // The plain `cancellation` of a form needs no label.
    for (const metric::Statistic& statistic : metric::statistics) {
        const std::string column = evaluate::column_name(*metric::find_metric("cancellation"), statistic);
        if (claim.metric == column) return;

        if (!names.empty()) names.push_back(column);
    }
    if (!names.empty())
        scene::toml::fail(claim.quantity, "unknown metric \"" + claim.metric + "\" of " + claim.form + "; " +
                                              text::did_you_mean(claim.metric, names));
}

double ClaimColumns::culprit_fraction(const Claim& claim, const FormSummary& summary) const {
    const auto culprit_index =
        static_cast<std::size_t>(std::ranges::find_if(metrics_, &Metric::depends_on_forms) - metrics_.begin());
    const auto categories = metrics_[culprit_index]->categories;
    std::vector<std::size_t> category_indices;
    for (const std::string& text : claim.operations) {
        for (const std::string& operation : find_operations(text, claim, setting_)) {
            const auto index = static_cast<std::size_t>(std::ranges::find(categories, operation) - categories.begin());
            if (std::ranges::find(category_indices, index) == category_indices.end()) category_indices.push_back(index);
        }
    }
    return attribution::culprit_fraction(summary.categories[culprit_index], category_indices);
}

double ClaimColumns::value(const Claim& claim, const FormSummary& summary) const {
    if (!claim.operations.empty()) return culprit_fraction(claim, summary);
    const auto columns = number_columns(metrics_);
    if (const SummaryColumn* const column = evaluate::find_column(columns, claim.metric)) return column->value(summary);
    std::vector<std::string> names;
    for (const SummaryColumn& column : columns) names.push_back(column.name);
    add_other_columns(names);
    scene::toml::fail(claim.quantity, "unknown metric \"" + claim.metric + "\"; " +
                                          text::did_you_mean(claim.metric, names) +
                                          " (`lostbits list metrics` lists the metrics)");
}

}  // namespace lostbits::measure::check
