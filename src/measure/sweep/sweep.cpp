#include "measure/sweep/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <stdexcept>

#include "intersect/process/parallel.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;
using evaluate::FormSummary;
using evaluate::TestedForm;
using intersect::Stop;
using metric::Metric;

namespace {

/// Measures rows at one step.
std::vector<FormSummary> run_step(const SweepRequest& request, const std::vector<TestedForm>& rows,
                                  const std::vector<double>& values) {
    return evaluate::measure_groups(request.sweep.rays(values), rows, request.metrics, request.limit);
}

/// Event whose first step is searched: it happens when its value reaches the threshold. A missing value is NaN.
struct Event {
    std::string name, statistic;
    double threshold;
    std::function<double(const FormSummary&)> value;

    [[nodiscard]] bool happens(const FormSummary& s) const { return value(s) >= threshold; }
    /// False for NaN: a form that hits nothing any more loses no bits, but is not good again.
    [[nodiscard]] bool is_good(const FormSummary& s) const { return value(s) < threshold; }
};

/// True for a metric of the loss in a step to object space or back, in ulps.
bool is_step(const Metric& m) { return (m.needs & metric::needs_steps) != 0 && m.ramp == metric::Ramp::magnitude; }

std::vector<Event> events_of(const TestedForm& row, const std::vector<const Metric*>& metrics) {
    const std::size_t lost = metric::index_of(metrics, "lost_bits"), stop = metric::index_of(metrics, "stop");
    std::vector<Event> events;
    const double p = row.format.parameters.precision;
    for (const metric::Statistic& s : metric::quantiles) {
        for (const double bits : {1.0, 4.0, 8.0, p / 2, p}) {
            if (bits > p) continue;
            events.push_back({"lost_bits", std::string(s.name), bits,
                              [lost, s](const FormSummary& m) { return s.of(m.metrics[lost]); }});
        }
    }
    for (std::size_t m = 0; m < metrics.size(); ++m) {
        if (!is_step(*metrics[m])) continue;
        events.push_back({std::string(metrics[m]->name), "p50", 1,
                          [m](const FormSummary& s) { return metric::quantiles.front().of(s.metrics[m]); }});
    }
    for (const Outcome o : evaluate::wrong_decisions) {
        events.push_back({std::string(answer::outcome_names[static_cast<std::size_t>(o)]), "count", 1,
                          [o](const FormSummary& m) { return static_cast<double>(m.count(o)); }});
    }
    if (is_primitive(row.form->shape) || stop == metrics.size()) return events;
    for (const Stop why : {Stop::max_dist, Stop::max_steps, Stop::stagnated}) {
        const auto c = static_cast<std::size_t>(why);
        events.push_back({std::string(intersect::stop_names[c]), "count", 1,
                          [stop, c](const FormSummary& m) { return static_cast<double>(m.categories[stop][c]); }});
    }
    return events;
}

/// Request that measures only the metrics that events need, because conditioning costs far more. Each keeps its index
/// among the metrics of the request.
SweepRequest for_events(SweepRequest request) {
    std::ranges::replace_if(
        request.metrics,
        [](const Metric* m) {
            return m->domain != metric::MetricDomain::marches && m->domain != metric::MetricDomain::pairs &&
                   !is_step(*m);
        },
        metric::find_metric("lost_bits"));
    return request;
}

/// Evaluates a row between the steps and remembers the results, because neighbouring events need the same values.
class StepsBetween {
public:
    StepsBetween(const SweepRequest& request, std::size_t row)
        : request_(for_events(request)), row_{request_.rows[row]} {}
    const FormSummary& at(double value) {
        const auto [place, fresh] = seen_.try_emplace(value);
        if (fresh) place->second = std::move(run_step(request_, row_, {value}).front());
        return place->second;
    }

private:
    SweepRequest request_;
    std::vector<TestedForm> row_;
    std::map<double, FormSummary> seen_;
};

/// Halves a bracket until it is narrow. `holds` is true at `first` and false at `second`. `at_second` is called with
/// every summary that `second` moves to.
template <class Holds, class AtSecond>
void narrow(const scene::sweep::Axis& axis, double& first, double& second, StepsBetween& between, const Holds& holds,
            const AtSecond& at_second) {
    while (std::fabs(second - first) > 0x1p-9 * std::fabs(second)) {
        const double middle = axis.middle(first, second);
        if (middle == first || middle == second) return;
        const FormSummary& there = between.at(middle);
        if (holds(there)) {
            first = middle;
        } else {
            second = middle;
            at_second(there);
        }
    }
}

/// Steps in the order in which an onset is looked for.
using Read = std::vector<const SweepStep*>;

/// Finds the last step after `bad` at which the form is good again, and the value at which it stops being good.
void find_recovery(const SweepRequest& request, const Read& steps, std::size_t bad, const Event& event,
                   StepsBetween& between, Onset& onset) {
    std::size_t good = steps.size() - 1;
    while (good > bad && !event.is_good(steps[good]->rows[onset.row])) --good;
    if (good == bad) return;
    onset.recovers = true;
    onset.good_at_end = good + 1 == steps.size();
    onset.last_good_after = steps[good]->values.front();
    if (onset.good_at_end) return;
    onset.bad_again = steps[good + 1]->values.front();
    narrow(
        request.sweep.axes.front(), onset.last_good_after, onset.bad_again, between,
        [&](const FormSummary& s) { return event.is_good(s); }, [](const FormSummary&) {});
}

Onset locate(const SweepRequest& request, const Read& steps, std::size_t row, const Event& event,
             StepsBetween& between) {
    Onset onset{row, event.name, event.statistic, event.threshold};
    onset.rays = steps.front()->rows[row].rays;
    onset.views = steps.front()->rows[row].views;
    const auto bad = std::ranges::find_if(steps, [&](const SweepStep* s) { return event.happens(s->rows[row]); });
    if (bad == steps.end()) return onset;
    onset.found = true;
    onset.first_bad = (*bad)->values.front();
    onset.value_at_first_bad = event.value((*bad)->rows[row]);
    if (request.recoveries)
        find_recovery(request, steps, static_cast<std::size_t>(bad - steps.begin()), event, between, onset);
    if (bad == steps.begin()) {
        onset.from_start = true;
        return onset;
    }
    onset.last_good = (*std::prev(bad))->values.front();
    narrow(
        request.sweep.axes.front(), onset.last_good, onset.first_bad, between,
        [&](const FormSummary& s) { return !event.happens(s); },
        [&](const FormSummary& s) { onset.value_at_first_bad = event.value(s); });
    return onset;
}

/// Finds the onsets on the rays of one draw.
std::vector<Onset> onsets_of_draw(const SweepRequest& request, const std::vector<SweepStep>& steps) {
    Read forwards;
    for (const SweepStep& step : steps) forwards.push_back(&step);
    const Read backwards(forwards.rbegin(), forwards.rend());
    std::vector<std::vector<Onset>> found(request.rows.size());
    intersect::process::in_parallel(std::size_t{0}, request.rows.size(), [&](std::size_t row) {
        StepsBetween between(request, row);
        for (const Event& event : events_of(request.rows[row], request.metrics)) {
            if (!request.asks_for({row, event.name, event.statistic, event.threshold})) continue;
            found[row].push_back(locate(request, forwards, row, event, between));
            if (!request.both_ends) continue;
            found[row].push_back(locate(request, backwards, row, event, between));
            found[row].back().from_last = true;
        }
        request.progress(steps.size());
    });
    std::vector<Onset> onsets;
    for (auto& row : found) onsets.insert(onsets.end(), row.begin(), row.end());
    return onsets;
}

}  // namespace

std::vector<SweepStep> run_sweep(const SweepRequest& request) {
    const auto& axes = request.sweep.axes;
    std::vector<SweepStep> steps;
    for (const double first : axes[0].values) {
        if (axes.size() == 1) {
            steps.push_back({{first}, {}});
            continue;
        }
        for (const double second : axes[1].values) steps.push_back({{first, second}, {}});
    }
    const auto units = request.share.of_units(steps.size());
    steps.erase(steps.begin() + static_cast<std::ptrdiff_t>(units.last), steps.end());
    steps.erase(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(units.first));
    intersect::process::in_parallel(std::size_t{0}, steps.size(), [&](std::size_t i) {
        steps[i].rows = run_step(request, request.rows, steps[i].values);
        request.progress(request.rows.size());
    });
    return steps;
}

std::vector<FormSummary> run_place(const SweepRequest& request, const std::vector<double>& values) {
    return run_step(request, request.rows, values);
}

std::vector<Onset> find_onsets(const SweepRequest& request, const std::vector<SweepStep>& steps) {
    if (request.sweep.axes.size() != 1) return {};
    std::vector<Onset> onsets = onsets_of_draw(request, steps);
    if (!request.sweep.has_random_rays()) return onsets;
    for (int draw = 1; draw <= request.further_draws; ++draw) {
        const scene::sweep::SweepFile again = request.sweep.with_seed_offset(draw);
        const SweepRequest other{.sweep = again,
                                 .rows = request.rows,
                                 .metrics = for_events(request).metrics,
                                 .both_ends = request.both_ends,
                                 .only = request.only,
                                 .limit = request.limit,
                                 .progress = request.progress};
        const std::vector<Onset> found = onsets_of_draw(other, run_sweep(other));
        for (Onset& onset : onsets) {
            const auto same = std::ranges::find_if(found, [&onset](const Onset& o) { return o.is_of_event(onset); });
            if (same == found.end())
                throw std::logic_error("a further draw of a sweep has other events than the first");
            onset.further.push_back(same->found ? same->first_bad : truth::missing);
        }
    }
    return onsets;
}

void SweepFindings::append(SweepFindings&& after) {
    std::ranges::move(after.steps, std::back_inserter(steps));
    std::ranges::move(after.onsets, std::back_inserter(onsets));
}

SweepFindings measure_sweep(const SweepRequest& request) {
    SweepFindings found{run_sweep(request), {}};
    if (request.share.is_whole()) {
        found.onsets = find_onsets(request, found.steps);
        return found;
    }
    const auto rows = request.share.of_units(request.rows.size());
    if (rows.size() == 0 || request.sweep.axes.size() != 1) return found;
    SweepRequest own = for_events(request);
    own.share = {};
    own.rows = {request.rows.begin() + static_cast<std::ptrdiff_t>(rows.first),
                request.rows.begin() + static_cast<std::ptrdiff_t>(rows.last)};
    found.onsets = find_onsets(own, run_sweep(own));
    for (Onset& onset : found.onsets) onset.row += rows.first;
    return found;
}

std::uint64_t sweep_units(const SweepRequest& request) {
    std::uint64_t steps = 1;
    for (const auto& axis : request.sweep.axes) steps *= axis.values.size();
    const auto draws = static_cast<std::uint64_t>(1 + (request.sweep.has_random_rays() ? request.further_draws : 0));
    return request.rows.size() * steps * (request.sweep.axes.size() == 1 ? 2 * draws : 1);
}

FormSummary run_cases_together(const CaseRequest& request, std::size_t row, const std::vector<std::size_t>& numbers) {
    const evaluate::TestedForm& what = request.rows[row];
    std::vector<scene::rays::RayGroup> groups;
    for (const std::size_t number : numbers) {
        for (scene::rays::RayGroup& group : request.file.rays(number, what.format.parameters))
            groups.push_back(std::move(group));
    }
    return std::move(evaluate::measure_groups(std::move(groups), {what}, request.metrics, request.limit).front());
}

std::vector<std::vector<FormSummary>> run_cases(const CaseRequest& request) {
    std::map<std::string, std::vector<std::size_t>> by_format;
    for (std::size_t row = 0; row < request.rows.size(); ++row) by_format[request.rows[row].format.name].push_back(row);
    const auto units = request.share.of_units(request.file.size());
    std::vector<std::vector<FormSummary>> cases(units.size());
    intersect::process::in_parallel(std::size_t{0}, cases.size(), [&](std::size_t i) {
        cases[i].resize(request.rows.size());
        for (const auto& [name, places] : by_format) {
            std::vector<evaluate::TestedForm> rows;
            for (const std::size_t row : places) rows.push_back(request.rows[row]);
            auto summaries =
                evaluate::measure_groups(request.file.rays(units.first + i, rows.front().format.parameters), rows,
                                         request.metrics, request.limit);
            for (std::size_t k = 0; k < places.size(); ++k) cases[i][places[k]] = std::move(summaries[k]);
        }
        request.progress(request.rows.size());
    });
    return cases;
}

Verdict verdict_of(const FormSummary& s, const std::vector<const metric::Metric*>& metrics, double within) {
    if (s.count(Outcome::unresolved) > 0) return Verdict::unresolved;
    if (const auto wrong = s.wrong()) {
        return *wrong == Outcome::not_a_number ? Verdict::not_a_number
               : *wrong == Outcome::false_miss ? Verdict::false_miss
               : *wrong == Outcome::false_hit  ? Verdict::false_hit
                                               : Verdict::wrong_primitive;
    }
    // NaN where form and truth agree on no hit: nothing is lost then.
    const auto most = [&](const char* name) { return s.metrics[metric::index_of(metrics, name)].quantile(1); };
    if (most("excess_bits") > within) return Verdict::wrong_value;
    return most("lost_bits") > within ? Verdict::within_inputs : Verdict::right;
}

}  // namespace lostbits::measure::sweep
