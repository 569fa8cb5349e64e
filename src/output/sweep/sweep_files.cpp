// Tables of a sweep.
#include "output/sweep/sweep_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "output/attribution/explain_command.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::sweep {
using table::Table;
using table::when;

namespace {

template <class Row>
Table<StepRow<Row>> step_columns(const SweepRequest& request, const Table<Row>& columns) {
    using R = StepRow<Row>;
    Table<R> table;
    std::size_t axis_index = 0;
    for (const scene::sweep::Axis& axis : request.sweep.axes)
        table.add_exact(
            {axis.name, axis.unit, "value of the axis", [k = axis_index++](const R& r) { return r.step->values[k]; }});
    return table.add(columns, &R::row);
}

constexpr const char* views_meaning =
    "sets of rays that each have a primitive and a direction of their own, and so are independent samples";

}  // namespace

Table<SampleRow> sample_table(const SweepRequest& request) {
    auto summary = map::make_summary_table(request.metrics, request.sweep.shapes(), request.sweep.has_mesh());
    // Rays of a sweep form no picture. The position of the worst ray is its index in its set.
    summary.set_meaning("worst_x", "ray with the largest |ulp_error| in its group, from 0");
    summary.set_meaning("worst_y", "row of a scene's picture, 0 for a ray distribution");
    summary.add({"views", views_meaning, [](const map::SummaryRow& row) { return row.summary->view_count; }});
    return step_columns(request, summary);
}

std::vector<SampleRow> sample_rows(const SweepRequest& request, const std::vector<SweepStep>& steps) {
    const auto ray_arguments = [](const measure::evaluate::WorstRay& ray) {
        return attribution::explain_ray_arguments(ray.given.get());
    };
    std::vector<SampleRow> rows;
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r)
        for (const SweepStep& step : steps)
            rows.push_back({&step, {request.tested_forms[r], &step.summaries[r], ray_arguments}});
    return rows;
}

Table<Onset> make_onset_table(const SweepRequest& request) {
    using R = Onset;
    const scene::sweep::Axis& axis = request.sweep.axes.front();

    // Values of cells that more than one column shows, and that are missing in some rows.
    const auto is_good = [](const R& r) { return r.found && !r.happens_at_start; };
    const auto is_bad_again = [](const R& r) { return r.recovers && !r.is_good_at_end; };
    const auto last_good = [=](const R& r) { return when(is_good(r), r.last_good); };
    const auto first_bad = [](const R& r) { return when(r.found, r.first_bad); };
    const auto last_good_after = [](const R& r) { return when(r.recovers, r.last_good_after); };
    const auto bad_again = [=](const R& r) { return when(is_bad_again(r), r.bad_again); };

    // A value as a C hexadecimal float, and a statistic of the first bad values of all draws.
    const auto exact = [](const auto& value) { return [value](const R& r) { return table::hex_text(value(r)); }; };
    const auto of_draws = [](double measure::metric::Spread::*member) {
        return [member](const R& r) {
            const auto spread = r.spread();
            return when(spread.draws > 0, spread.*member);
        };
    };

    Table<R> table;
    table.add(
        table::make_subject_columns(), [&request](const R& r) -> const auto& {
            return request.tested_forms[r.form_index];
        });
    return table.add(
        {// the event
         {"event",
          "the event: lost_bits, or the loss in a step of a transform, reach the threshold, or an outcome occurs",
          &R::event},
         {"statistic", "p50, p99 or max over the rays of a step; count for an outcome", &R::statistic},
         {"threshold", "bits", "threshold of the statistic; in ulps for a step of a transform; 1 for a count",
          &R::threshold},
         {"read_from",
          "first: steps are read in their order; last: from the last step backwards, so that `first` and `last` below "
          "are the other way round",
          [](const R& r) { return r.reads_backwards ? "last" : "first"; }},

         // the first values at which it happens
         {"found", "true if the event happens within the sweep", &R::found},
         {"last_good_" + axis.name, axis.unit,
          "last value before the event, in reading order; missing if the step where reading starts is bad already",
          last_good},
         {"first_bad_" + axis.name, axis.unit,
          "first value at which it is seen: one of the steps, narrowed by bisection between two; it may happen earlier "
          "between samples",
          first_bad},
         {"last_good_hex", axis.unit, "the last good value, exactly", exact(last_good)},
         {"first_bad_hex", axis.unit, "the first bad value, exactly", exact(first_bad)},
         {"value_at_first_bad", "the statistic at the first bad value",
          [](const R& r) { return when(r.found, r.value_at_first_bad); }},

         // the values at which it ends
         {"recovers", "true if a step after the first bad one is good again", &R::recovers},
         {"last_good_after_" + axis.name, axis.unit,
          "the last good value after the first bad one; missing if no later value is good", last_good_after},
         {"bad_again_" + axis.name, axis.unit,
          "value from which it is bad to the end, narrowed by bisection; missing if the last step is good", bad_again},
         {"last_good_after_hex", axis.unit, "that last good value, exactly", exact(last_good_after)},
         {"bad_again_hex", axis.unit, "that value, exactly", exact(bad_again)},

         // the samples
         {"rays", "number of rays in each step; with more rays the first failure comes earlier", &R::ray_count},
         {"views", views_meaning, &R::view_count},

         // the same event for other draws of the rays
         {"draws", "sets of rays tried, one per seed; the columns above are for the file's own seed",
          [](const R& r) { return 1 + r.further_first_bad.size(); }},
         {"draws_found", "draws in which the event happens within the sweep; the columns below are about these draws",
          [](const R& r) { return r.spread().draws; }},
         {"first_bad_low", axis.unit, "smallest first bad value of these draws",
          of_draws(&measure::metric::Spread::low)},
         {"first_bad_median", axis.unit, "median first bad value of these draws, the lower of two",
          of_draws(&measure::metric::Spread::median)},
         {"first_bad_high", axis.unit, "largest first bad value of these draws",
          of_draws(&measure::metric::Spread::high)}});
}

void SweepWriter::require_own_columns(const SweepRequest& request) {
    for (const auto& columns : {sample_table(request).columns(), make_onset_table(request).columns(),
                                step_columns(request, map::make_culprit_table()).columns()}) {
        std::set<std::string> names;
        for (const file::Column& column : columns) {
            if (names.insert(column.name).second) continue;
            const auto& axes = request.sweep.axes;
            const auto named_axis = std::ranges::find_if(
                axes, [&column](const auto& axis) { return column.name.find(axis.name) != std::string::npos; });
            if (named_axis == axes.end()) throw std::logic_error("column " + column.name + " appears twice");
            scene::toml::fail(
                named_axis->where,
                fmt::format("an axis named \"{}\" would give the results two columns named \"{}\"; choose another name",
                            named_axis->name, column.name));
        }
    }
}

SweepWriter::SweepWriter(const SweepRequest& request, const std::filesystem::path& folder)
    : request_(request),
      folder_(folder),
      samples_(folder, "samples.csv", "One row per form, format and step", sample_table(request)) {
    // An onset is a position on one axis.
    if (request.sweep.axes.size() == 1)
        onsets_.emplace(folder, "onsets.csv", "One row per form, format, event, threshold and end of the axis",
                        make_onset_table(request));
    if (map::asks_for_culprits(request.metrics))
        culprits_.emplace(folder, "culprits.csv", "One row per form, format, step and operation that is a culprit",
                          step_columns(request, map::make_culprit_table()));
}

void SweepWriter::finish(const std::vector<SweepStep>& steps, const std::vector<Onset>& onsets) {
    samples_.add_all(sample_rows(request_, steps));
    if (onsets_) onsets_->add_all(onsets);
    for (std::size_t r = 0; culprits_ && r < request_.tested_forms.size(); ++r)
        for (const SweepStep& step : steps)
            for (const auto& culprit :
                 map::find_culprits(request_.metrics, request_.tested_forms[r], step.summaries[r]))
                culprits_->add({&step, culprit});
    table::close_tables(folder_, request_.sweep.title, samples_, onsets_, culprits_);
}

}  // namespace lostbits::output::sweep
