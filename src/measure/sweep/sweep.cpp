#include "measure/sweep/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <ranges>
#include <stdexcept>

#include "intersect/process/parallel.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;
using evaluate::FormSummary;
using evaluate::TestedForm;
using intersect::StopReason;
using metric::Metric;

namespace {

/// Number of the sweep's steps.
std::uint64_t count_steps(const scene::sweep::SweepFile& sweep) {
    std::uint64_t steps = 1;
    for (const auto& axis : sweep.axes) steps *= axis.values.size();
    return steps;
}

/// Event whose onset is searched. It happens at a step if its value there reaches the threshold. A missing value is
/// NaN.
struct Event {
    std::string name, statistic;
    double threshold;
    std::function<double(const FormSummary&)> value;

    [[nodiscard]] bool happens(const FormSummary& summary) const { return value(summary) >= threshold; }
    /// False for NaN: a form that no longer hits anything loses no bits, but is not good again.
    [[nodiscard]] bool is_good(const FormSummary& summary) const { return value(summary) < threshold; }
};

/// True for a metric of the loss, in ulps, in a transform step: on the way to object space or back.
bool measures_transform_step(const Metric& m) {
    return (m.needs & metric::needs_steps) != 0 && m.ramp == metric::Ramp::magnitude;
}

/// Adds a loss of 1, 4 and 8 bits, of half and of all bits, for each quantile.
void add_losses(std::vector<Event>& events, double precision, const std::vector<const Metric*>& metrics) {
    const std::size_t lost_bits_index = metric::index_of(metrics, "lost_bits");
    for (const metric::Statistic& statistic : metric::quantile_statistics) {
        for (const double bits : {1.0, 4.0, 8.0, precision / 2, precision}) {
            if (bits > precision) continue;
            events.push_back({"lost_bits", std::string(statistic.name), bits,
                              [lost_bits_index, statistic](const FormSummary& summary) {
                                  return statistic.of(summary.metrics[lost_bits_index]);
                              }});
        }
    }
}

/// Adds a median loss of one ulp in each transform step.
void add_step_losses(std::vector<Event>& events, const std::vector<const Metric*>& metrics) {
    for (std::size_t m = 0; m < metrics.size(); ++m) {
        if (!measures_transform_step(*metrics[m])) continue;
        events.push_back({std::string(metrics[m]->name), "p50", 1, [m](const FormSummary& summary) {
                              return metric::quantile_statistics.front().of(summary.metrics[m]);
                          }});
    }
}

/// Adds each wrong decision, from one ray on.
void add_wrong_decisions(std::vector<Event>& events) {
    for (const Outcome o : evaluate::wrong_decisions) {
        events.push_back({std::string(answer::outcome_names[static_cast<std::size_t>(o)]), "count", 1,
                          [o](const FormSummary& summary) { return static_cast<double>(summary.count(o)); }});
    }
}

/// Adds each reason for which a march stops other than a hit, from one ray on.
void add_stops(std::vector<Event>& events, std::size_t stop_index) {
    for (const StopReason stop_reason : {StopReason::max_dist, StopReason::max_steps, StopReason::stagnated}) {
        const auto stop_category = static_cast<std::size_t>(stop_reason);
        events.push_back({std::string(intersect::stop_names[stop_category]), "count", 1,
                          [stop_index, stop_category](const FormSummary& summary) {
                              return static_cast<double>(summary.categories[stop_index][stop_category]);
                          }});
    }
}

std::vector<Event> list_events(const TestedForm& tested_form, const std::vector<const Metric*>& metrics) {
    std::vector<Event> events;
    add_losses(events, tested_form.format.parameters.precision, metrics);
    add_step_losses(events, metrics);
    add_wrong_decisions(events);
    const std::size_t stop_index = metric::index_of(metrics, "stop");
    if (!is_primitive(tested_form.form->shape) && stop_index != metrics.size()) add_stops(events, stop_index);
    return events;
}

/// Returns a request that measures only the metrics that events need, because conditioning costs far more. Each of
/// these metrics keeps its index among the metrics of the request.
SweepRequest make_request_for_events(SweepRequest request) {
    std::ranges::replace_if(
        request.metrics,
        [](const Metric* m) {
            return m->domain != metric::MetricDomain::marches && m->domain != metric::MetricDomain::pairs &&
                   !measures_transform_step(*m);
        },
        metric::find_metric("lost_bits"));
    return request;
}

/// Evaluates a row at values between the steps and remembers the results, because neighbouring events need the same
/// values.
class FormEvaluator {
public:
    FormEvaluator(const SweepRequest& request, std::size_t form_index) : request_(make_request_for_events(request)) {
        request_.tested_forms = {request.tested_forms[form_index]};
    }
    const FormSummary& summary_at(double value) {
        const auto [entry, is_new] = summaries_.try_emplace(value);
        if (is_new) entry->second = std::move(measure_at(request_, {value}).front());
        return entry->second;
    }

private:
    SweepRequest request_;
    std::map<double, FormSummary> summaries_;
};

/// Halves the bracket [first, second] until it is narrow. `holds` is true at `first` and false at `second`. `on_second`
/// is called with the summary at every value that `second` moves to.
template <class Holds, class OnSecond>
void narrow_bracket(const scene::sweep::Axis& axis, double& first, double& second, FormEvaluator& evaluator,
                    const Holds& holds, const OnSecond& on_second) {
    while (std::fabs(second - first) > 0x1p-9 * std::fabs(second)) {
        const double middle = axis.middle(first, second);
        if (middle == first || middle == second) return;
        const FormSummary& summary = evaluator.summary_at(middle);
        if (holds(summary)) {
            first = middle;
        } else {
            second = middle;
            on_second(summary);
        }
    }
}

/// Steps in the order in which an onset is searched.
using StepOrder = std::vector<const SweepStep*>;

/// Finds the last step after step `bad_index` at which the form is good again, and the value at which it stops being
/// good.
void find_recovery(const SweepRequest& request, const StepOrder& steps, std::size_t bad_index, const Event& event,
                   FormEvaluator& evaluator, Onset& onset) {
    std::size_t good_index = steps.size() - 1;
    while (good_index > bad_index && !event.is_good(steps[good_index]->summaries[onset.form_index])) --good_index;
    if (good_index == bad_index) return;

    onset.recovers = true;
    onset.is_good_at_end = good_index + 1 == steps.size();
    onset.last_good_after = steps[good_index]->values.front();
    if (onset.is_good_at_end) return;

    onset.bad_again = steps[good_index + 1]->values.front();
    narrow_bracket(
        request.sweep.axes.front(), onset.last_good_after, onset.bad_again, evaluator,
        [&](const FormSummary& summary) { return event.is_good(summary); }, [](const FormSummary&) {});
}

Onset locate_onset(const SweepRequest& request, const StepOrder& steps, std::size_t form_index, const Event& event,
                   FormEvaluator& evaluator) {
    Onset onset{form_index, event.name, event.statistic, event.threshold};
    onset.ray_count = steps.front()->summaries[form_index].ray_count;
    onset.view_count = steps.front()->summaries[form_index].view_count;
    const auto first_bad_step =
        std::ranges::find_if(steps, [&](const SweepStep* s) { return event.happens(s->summaries[form_index]); });
    if (first_bad_step == steps.end()) return onset;

    onset.found = true;
    onset.first_bad = (*first_bad_step)->values.front();
    onset.value_at_first_bad = event.value((*first_bad_step)->summaries[form_index]);
    if (request.recoveries)
        find_recovery(request, steps, static_cast<std::size_t>(first_bad_step - steps.begin()), event, evaluator,
                      onset);

    // Locates the onset between the last good step and the first bad one.
    if (first_bad_step == steps.begin()) {
        onset.happens_at_start = true;
        return onset;
    }
    onset.last_good = (*std::prev(first_bad_step))->values.front();
    narrow_bracket(
        request.sweep.axes.front(), onset.last_good, onset.first_bad, evaluator,
        [&](const FormSummary& summary) { return !event.happens(summary); },
        [&](const FormSummary& summary) { onset.value_at_first_bad = event.value(summary); });
    return onset;
}

/// Finds the onsets on the rays of one draw.
std::vector<Onset> find_onsets_of_draw(const SweepRequest& request, const std::vector<SweepStep>& steps) {
    StepOrder forward_steps;
    for (const SweepStep& step : steps) forward_steps.push_back(&step);
    const StepOrder backward_steps(forward_steps.rbegin(), forward_steps.rend());
    std::vector<std::vector<Onset>> onsets_by_row(request.tested_forms.size());
    intersect::process::in_parallel(std::size_t{0}, request.tested_forms.size(), [&](std::size_t form_index) {
        FormEvaluator evaluator(request, form_index);
        for (const Event& event : list_events(request.tested_forms[form_index], request.metrics)) {
            if (!request.wants_onset({form_index, event.name, event.statistic, event.threshold})) continue;
            onsets_by_row[form_index].push_back(locate_onset(request, forward_steps, form_index, event, evaluator));
            if (!request.both_ends) continue;
            onsets_by_row[form_index].push_back(locate_onset(request, backward_steps, form_index, event, evaluator));
            onsets_by_row[form_index].back().reads_backwards = true;
        }
        request.progress(steps.size());
    });
    std::vector<Onset> onsets;
    for (auto& row : onsets_by_row) onsets.insert(onsets.end(), row.begin(), row.end());
    return onsets;
}

}  // namespace

std::vector<SweepStep> run_sweep(const SweepRequest& request) {
    const auto units = request.share.unit_range(count_steps(request.sweep));
    std::vector<SweepStep> steps(units.size());
    intersect::process::in_parallel(std::size_t{0}, steps.size(), [&](std::size_t i) {
        // The second axis runs fastest.
        std::size_t index = units.first + i;
        for (const auto& axis : request.sweep.axes | std::views::reverse) {
            steps[i].values.insert(steps[i].values.begin(), axis.values[index % axis.values.size()]);
            index /= axis.values.size();
        }
        steps[i].summaries = measure_at(request, steps[i].values);
        request.progress(request.tested_forms.size());
    });
    return steps;
}

std::vector<FormSummary> measure_at(const SweepRequest& request, const std::vector<double>& values) {
    return evaluate::measure_groups(request.sweep.rays(values), request.tested_forms, request.metrics, request.limit);
}

std::vector<Onset> find_onsets(const SweepRequest& request, const std::vector<SweepStep>& steps) {
    if (request.sweep.axes.size() != 1) return {};
    std::vector<Onset> onsets = find_onsets_of_draw(request, steps);
    if (!request.sweep.has_random_rays()) return onsets;

    // Repeats the search on other random rays, to see how far the onsets scatter.
    for (int draw = 1; draw <= request.further_draw_count; ++draw) {
        const scene::sweep::SweepFile sweep_of_draw = request.sweep.with_seed_offset(draw);
        const SweepRequest draw_request{.sweep = sweep_of_draw,
                                        .tested_forms = request.tested_forms,
                                        .metrics = make_request_for_events(request).metrics,
                                        .both_ends = request.both_ends,
                                        .wanted_onsets = request.wanted_onsets,
                                        .limit = request.limit,
                                        .progress = request.progress};

        const std::vector<Onset> draw_onsets = find_onsets_of_draw(draw_request, run_sweep(draw_request));
        for (Onset& onset : onsets) {
            const auto match =
                std::ranges::find_if(draw_onsets, [&onset](const Onset& o) { return o.is_same_event(onset); });
            if (match == draw_onsets.end())
                throw std::logic_error("a further draw of a sweep has other events than the first");
            onset.further_first_bad.push_back(match->found ? match->first_bad : truth::missing);
        }
    }
    return onsets;
}

void SweepFindings::append(SweepFindings&& next_share) {
    std::ranges::move(next_share.steps, std::back_inserter(steps));
    std::ranges::move(next_share.onsets, std::back_inserter(onsets));
}

SweepFindings measure_sweep(const SweepRequest& request) {
    SweepFindings findings{run_sweep(request), {}};
    if (request.share.is_whole()) {
        findings.onsets = find_onsets(request, findings.steps);
        return findings;
    }
    const auto rows = request.share.unit_range(request.tested_forms.size());
    if (rows.size() == 0 || request.sweep.axes.size() != 1) return findings;
    SweepRequest share_request = make_request_for_events(request);
    share_request.share = {};
    share_request.tested_forms = {request.tested_forms.begin() + static_cast<std::ptrdiff_t>(rows.first),
                                  request.tested_forms.begin() + static_cast<std::ptrdiff_t>(rows.last)};
    findings.onsets = find_onsets(share_request, run_sweep(share_request));
    for (Onset& onset : findings.onsets) onset.form_index += rows.first;
    return findings;
}

std::uint64_t count_sweep_units(const SweepRequest& request) {
    const auto draws =
        static_cast<std::uint64_t>(1 + (request.sweep.has_random_rays() ? request.further_draw_count : 0));
    return request.tested_forms.size() * count_steps(request.sweep) * (request.sweep.axes.size() == 1 ? 2 * draws : 1);
}

FormSummary run_cases_together(const CaseRequest& request, std::size_t form_index,
                               const std::vector<std::size_t>& case_indices) {
    const evaluate::TestedForm& tested_form = request.tested_forms[form_index];
    std::vector<scene::rays::RayGroup> groups;
    for (const std::size_t case_index : case_indices) {
        for (scene::rays::RayGroup& group : request.file.rays(case_index, tested_form.format.parameters))
            groups.push_back(std::move(group));
    }
    return std::move(
        evaluate::measure_groups(std::move(groups), {tested_form}, request.metrics, request.limit).front());
}

std::vector<std::vector<FormSummary>> run_cases(const CaseRequest& request) {
    std::map<std::string, std::vector<std::size_t>> rows_by_format;
    for (std::size_t form_index = 0; form_index < request.tested_forms.size(); ++form_index)
        rows_by_format[request.tested_forms[form_index].format.name].push_back(form_index);

    const auto units = request.share.unit_range(request.file.size());
    std::vector<std::vector<FormSummary>> cases(units.size());
    intersect::process::in_parallel(std::size_t{0}, cases.size(), [&](std::size_t i) {
        cases[i].resize(request.tested_forms.size());
        for (const auto& [format_name, rows_of_format] : rows_by_format) {
            std::vector<evaluate::TestedForm> tested_forms;
            for (const std::size_t form_index : rows_of_format)
                tested_forms.push_back(request.tested_forms[form_index]);

            auto summaries =
                evaluate::measure_groups(request.file.rays(units.first + i, tested_forms.front().format.parameters),
                                         tested_forms, request.metrics, request.limit);
            for (std::size_t k = 0; k < rows_of_format.size(); ++k)
                cases[i][rows_of_format[k]] = std::move(summaries[k]);
        }
        request.progress(request.tested_forms.size());
    });
    return cases;
}

Verdict verdict_of(const FormSummary& summary, const std::vector<const metric::Metric*>& metrics, double max_bits) {
    if (summary.count(Outcome::unresolved) > 0) return Verdict::unresolved;
    if (const auto wrong = summary.most_frequent_wrong_decision()) {
        return *wrong == Outcome::not_a_number ? Verdict::not_a_number
               : *wrong == Outcome::false_miss ? Verdict::false_miss
               : *wrong == Outcome::false_hit  ? Verdict::false_hit
                                               : Verdict::wrong_primitive;
    }
    // The quantile is NaN if there is no hit on which form and truth agree. Nothing is lost then.
    const auto largest = [&](const char* name) { return summary.metrics[metric::index_of(metrics, name)].quantile(1); };
    if (largest("excess_bits") > max_bits) return Verdict::wrong_value;
    return largest("lost_bits") > max_bits ? Verdict::within_inputs : Verdict::right;
}

}  // namespace lostbits::measure::sweep
