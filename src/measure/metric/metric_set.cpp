#include "measure/metric/metric_set.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "measure/metric/values.hpp"
#include "number/error.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::measure::metric {

using intersect::table::Intersector;
using truth::missing;

namespace {

constexpr const char* no_culprit = "none: nothing rounds";

double contribution(const Sample& sample) {
    if (!sample.attribution) return missing;
    const Tape& tape = *sample.attribution->tape;
    const NodeId subject = sample.attribution->attribution->subject;
    if (subject == no_node || is_decision(tape[subject].op)) return missing;
    return attribution::contribution_of(tape, *sample.attribution->attribution, sample.label) / sample.attribution->ulp;
}

double cancellation(const Sample& sample) {
    return sample.attribution
               ? attribution::cancellation_of(*sample.attribution->tape, *sample.attribution->attribution, sample.label)
               : missing;
}

double step_error(const Sample& sample) {
    const auto found = std::ranges::find(intersect::transform::step_names, sample.label);
    const auto k = static_cast<std::size_t>(found - intersect::transform::step_names.begin());
    return sample.steps ? sample.steps->error(k, ulp_exponent(sample.format->parameters, sample.true_t->floor_log2()))
                        : missing;
}

double number_of(std::string_view label) {
    double x = missing;
    const char* const end = label.data() + label.size();
    return std::from_chars(label.data(), end, x).ptr == end && x >= 0 && std::isfinite(x) ? x : missing;
}

double beyond(const Sample& sample) { return distance_error(sample) > number_of(sample.label) ? 1 : 0; }
double too_few(const Sample& sample) { return correct_bits(sample) < number_of(sample.label) ? 1 : 0; }

constexpr std::string_view within_names[] = {"within", "beyond"}, enough_names[] = {"enough", "too_few"};

/// Metrics that a label completes. The label of the first two is a number, which is appended to `meaning`. The label of
/// the others is the name of an operation or a step, which is appended to `name` and `layer`.
constexpr Metric labelled_metrics[] = {
    table_row(
        {"tolerance:", "", "err.tolerance"},
        "tells whether the hit point is at most this far from the true one, along the ray, in the scene's unit of "
        "length: ",
        beyond, {.ramp = Ramp::categories, .categories = within_names}),
    table_row({"enough_bits:", "", "bits.enough"}, "tells whether t keeps this many bits (correct_bits): ", too_few,
              {.ramp = Ramp::categories, .categories = enough_names}),
    table_row({"contribution:", "ulp", "contribution."},
              "part of the error of t that is assigned to operations of that name, in ulps of t without rounding",
              contribution, {.needs = needs_attribution, .ramp = Ramp::magnitude, .low = 0x1p-4}),
    table_row({"cancellation:", "bits", "cancellation."},
              "bits that the operation of that name cancels in operands that were already wrong", cancellation,
              {.needs = needs_attribution}),
    table_row({"step:", "ulp", "space."},
              "part of the error of t that is assigned to that step to object space or back, for a primitive with a "
              "transform",
              step_error, {.needs = needs_steps, .ramp = Ramp::magnitude, .low = 0x1p-4})};

bool has_operation_label(const Metric& metric) { return !metric.label.empty() && metric.needs != needs_nothing; }

template <class Texts, class Text>
void add_once(Texts& texts, const Text& text) {
    if (std::ranges::find(texts, text) == texts.end()) texts.emplace_back(text);
}

void require_known_label(const Metric& metric, const std::vector<const Intersector*>& forms,
                         const attribution::Setting& setting) {
    std::vector<std::string> labels;

    // Steps have fixed names.
    if ((metric.needs & needs_steps) != 0) {
        if (std::ranges::find(intersect::transform::step_names, metric.label) != intersect::transform::step_names.end())
            return;
        labels.assign(intersect::transform::step_names.begin(), intersect::transform::step_names.end());
        const std::string label(metric.label);
        throw InputError("--metric " + std::string(metric.name) + ": no step is named \"" + label + "\"; " +
                         text::did_you_mean(label, labels));
    }

    // The names of operations are those of the forms.
    for (const Intersector* form : forms) {
        for (const std::string_view label : attribution::labels_of(*form, setting)) add_once(labels, label);
    }
    if (std::ranges::find(labels, metric.label) != labels.end()) return;
    const std::string label(metric.label);
    throw InputError(
        "--metric " + std::string(metric.name) + ": no selected form has an operation named \"" + label + "\"; " +
        (labels.empty() ? "none of the selected forms names its operations" : text::did_you_mean(label, labels)));
}

}  // namespace

const Metric* MetricSet::find(std::string_view name) {
    if (const Metric* const row = find_metric(name)) return row;
    const auto owned_metric = std::ranges::find(owned_, name, &OwnedMetric::name);
    if (owned_metric != owned_.end()) return &owned_metric->metric;

    // Makes the metric of a new label.
    const auto kind = std::ranges::find_if(labelled_metrics, [&](const Metric& metric) {
        return name.starts_with(metric.name) && name.size() > metric.name.size();
    });
    if (kind == std::end(labelled_metrics)) return nullptr;
    if (kind->needs == needs_nothing) return make_metric_with_number(*kind, name);

    OwnedMetric& owned = owned_.emplace_back();
    owned.name = name;
    owned.layer = std::string(kind->layer) + owned.name.substr(kind->name.size());
    owned.metric = *kind;
    owned.metric.name = owned.name;
    owned.metric.layer = owned.layer;
    owned.metric.label = owned.metric.name.substr(kind->name.size());
    return &owned.metric;
}

const Metric* MetricSet::make_metric_with_number(const Metric& kind, std::string_view name) {
    const std::string_view column = kind.name.substr(0, kind.name.size() - 1);
    if (std::isnan(number_of(name.substr(kind.name.size()))))
        throw InputError("--metric " + std::string(name) +
                         ": write a finite number of at least 0 after the colon, such as " + std::string(kind.name) +
                         (kind.value == beyond ? "0.001" : "16"));
    const auto other = std::ranges::find(owned_, column, [](const OwnedMetric& owned) { return owned.metric.name; });
    if (other != owned_.end())
        throw InputError("metrics " + other->name + " and " + std::string(name) +
                         ": differ in their number only, and a run measures one of them; leave one out");

    OwnedMetric& owned = owned_.emplace_back();
    owned.name = name;
    owned.metric = kind;
    owned.metric.name = column;
    owned.metric.label = std::string_view(owned.name).substr(kind.name.size());
    owned.meaning = std::string(kind.meaning) + std::string(owned.metric.label);
    owned.metric.meaning = owned.meaning;
    return &owned.metric;
}

const Metric* MetricSet::make_culprit(const std::vector<std::string>& operations) {
    OwnedMetric& owned = owned_.emplace_back();
    owned.operations = operations;
    owned.categories.emplace_back(no_culprit);
    owned.categories.insert(owned.categories.end(), owned.operations.begin(), owned.operations.end());
    owned.metric = *find_metric("culprit");
    owned.metric.categories = owned.categories;
    return &owned.metric;
}

std::vector<const Metric*> MetricSet::adapt_to_forms(std::vector<const Metric*> metrics,
                                                     const std::vector<const Intersector*>& forms,
                                                     const attribution::Setting& setting) {
    for (const Metric*& m : metrics) {
        if (has_operation_label(*m)) require_known_label(*m, forms, setting);
        if (!m->depends_on_forms) continue;
        std::vector<std::string> operations;
        for (const Intersector* form : forms) {
            for (const std::string& operation : attribution::operation_names(*form, setting))
                add_once(operations, operation);
        }
        m = make_culprit(operations);
    }
    return metrics;
}

std::vector<const Metric*> MetricSet::adapt_to_forms(std::vector<const Metric*> metrics,
                                                     const std::vector<const Intersector*>& forms,
                                                     const std::function<attribution::OwnedSetting()>& setting) {
    if (std::ranges::none_of(metrics, [](const Metric* m) { return m->depends_on_forms || has_operation_label(*m); }))
        return metrics;
    return adapt_to_forms(std::move(metrics), forms, setting().get());
}

}  // namespace lostbits::measure::metric
