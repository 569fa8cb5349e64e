#include "output/sweep/sweep_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "output/blame/explain_command.hpp"
#include "output/file/datapackage.hpp"
#include "output/file/number_text.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::output::sweep {

using file::Cell;
using file::Column;
using measure::sweep::Onset;
using measure::sweep::SweepRequest;

namespace {

std::vector<Column> axis_columns(const SweepRequest& request) {
    std::vector<Column> columns;
    for (const scene::sweep::Axis& axis : request.sweep->axes) {
        columns.push_back({axis.name, "number", axis.unit, "value of the axis"});
        columns.push_back({axis.name + "_hex", "string", axis.unit, "the same, exactly"});
    }
    return columns;
}

constexpr const char* views_meaning =
    "sets of rays with a solid and a direction of their own: the independent samples of what those share";

void add_axes(file::CsvWriter& csv, const measure::sweep::SweepStep& step) {
    for (const double value : step.values) csv.add(value).add(file::hex(value));
}

}  // namespace

std::vector<Column> sample_columns(const SweepRequest& request) {
    std::vector<Column> columns = axis_columns(request);
    // A sweep's rays have no picture: the place of the worst is its number in its set.
    for (Column& c : map::SummaryTable{request.metrics, request.sweep->shapes(), request.sweep->has_mesh()}.columns()) {
        if (c.name == "worst_x") c.meaning = "ray with the largest |ulp_error| in its group, from 0";
        if (c.name == "worst_y") c.meaning = "row of a scene's picture, 0 for a family";
        columns.push_back(std::move(c));
    }
    columns.push_back({"views", "integer", "", views_meaning});
    return columns;
}

std::vector<Column> onset_columns(const SweepRequest& request) {
    const scene::sweep::Axis& axis = request.sweep->axes.front();
    return {
        {"form", "string", "", "form under test"},
        {"format", "string", "", "format it computes in"},
        {"event", "string", "",
         "what is first seen to happen: lost_bits, or what a step of a space loses, reach the threshold, or an outcome "
         "occurs"},
        {"statistic", "string", "", "p50, p99 or max over the rays of a step; count of an outcome"},
        {"threshold", "number", "bits", "of the statistic; of a step of a space in ulps; 1 for a count"},
        {"read_from", "string", "",
         "first: the steps in their order; last: from the last one backwards, so that `first` and `last` below are the "
         "other way round"},
        {"found", "boolean", "", "whether it happens within the sweep"},
        {"last_good_" + axis.name, "number", axis.unit,
         "last value before it, in the order of reading; missing where the step it is read from is bad already"},
        {"first_bad_" + axis.name, "number", axis.unit,
         "first value at which it is seen to happen: of the steps, narrowed by bisection between two; it may happen "
         "earlier "
         "where nothing was sampled"},
        {"last_good_hex", "string", axis.unit, "the same, exactly"},
        {"first_bad_hex", "string", axis.unit, "the same, exactly"},
        {"value_at_first_bad", "number", "", "the statistic there"},
        {"recovers", "boolean", "", "whether a step after the first bad one is good again"},
        {"last_good_after_" + axis.name, "number", axis.unit,
         "the last value after the first bad one that is good; missing where none is"},
        {"bad_again_" + axis.name, "number", axis.unit,
         "from where on it is bad to the end, narrowed by bisection; missing where the last step is good"},
        {"last_good_after_hex", "string", axis.unit, "the same, exactly"},
        {"bad_again_hex", "string", axis.unit, "the same, exactly"},
        {"rays", "integer", "", "rays of each step: the first of more rays to fail does so earlier"},
        {"views", "integer", "", views_meaning},
        {"draws", "integer", "", "sets of rays tried, one a seed; the columns above are of the file's own seed"},
        {"draws_found", "integer", "", "draws in which it happens within the sweep; the columns below are of those"},
        {"first_bad_low", "number", axis.unit, "smallest first bad value of these draws"},
        {"first_bad_median", "number", axis.unit, "the middle one, the lower of two"},
        {"first_bad_high", "number", axis.unit, "the largest"}};
}

void SweepFiles::require_own_columns(const SweepRequest& request) {
    for (const auto& columns :
         {sample_columns(request), onset_columns(request), map::CulpritTable::columns(axis_columns(request))}) {
        std::set<std::string> names;
        for (const Column& column : columns) {
            if (names.insert(column.name).second) continue;
            const auto& axes = request.sweep->axes;
            const auto at = std::ranges::find_if(
                axes, [&column](const auto& axis) { return column.name.find(axis.name) != std::string::npos; });
            if (at == axes.end()) throw std::logic_error("column " + column.name + " appears twice");
            scene::toml::fail(at->where, fmt::format("an axis that is named \"{}\" gives the results two columns that "
                                                     "are named \"{}\"; choose another name",
                                                     at->name, column.name));
        }
    }
}

SweepFiles::SweepFiles(const SweepRequest& request, const std::filesystem::path& folder)
    : request_(request), folder_(folder), samples_(folder / "samples.csv", sample_columns(request)) {
    // An onset is a place on one axis.
    if (request.sweep->axes.size() == 1) onsets_.emplace(folder / "onsets.csv", onset_columns(request));
    if (map::CulpritTable::is_wanted(request.metrics))
        culprits_.emplace(folder / "culprits.csv", axis_columns(request), request.metrics);
}

void add_samples(file::CsvWriter& samples, const SweepRequest& request,
                 const std::vector<measure::sweep::SweepStep>& steps) {
    const map::SummaryTable table{request.metrics, request.sweep->shapes(), request.sweep->has_mesh()};
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        for (const measure::sweep::SweepStep& step : steps) {
            add_axes(samples, step);
            table.add(samples, request.rows[r], step.rows[r],
                      [](const measure::map::WorstRay& ray) { return blame::name_of_ray(ray.given.get()); });
            samples.add(step.rows[r].views);
            samples.end_row();
        }
    }
}

void SweepFiles::finish(const std::vector<measure::sweep::SweepStep>& steps, const std::vector<Onset>& onsets) {
    add_samples(samples_, request_, steps);
    for (std::size_t r = 0; culprits_ && r < request_.rows.size(); ++r) {
        for (const measure::sweep::SweepStep& step : steps)
            culprits_->add(request_.rows[r], step.rows[r], [&step](file::CsvWriter& csv) { add_axes(csv, step); });
    }
    std::vector<file::DataResource> resources{
        {"samples.csv", "One row per form, format and step", sample_columns(request_)}};
    if (onsets_) {
        add_onsets(*onsets_, request_, onsets);
        resources.push_back(
            {"onsets.csv", "One row per form, format, event, threshold and end of the axis", onset_columns(request_)});
    }
    if (culprits_)
        resources.push_back({"culprits.csv", "One row per form, format, step and operation that is a culprit",
                             map::CulpritTable::columns(axis_columns(request_))});
    file::write_datapackage(folder_ / "datapackage.json", request_.sweep->title, resources);
    if (onsets_) onsets_->close();
    if (culprits_) culprits_->close();
    samples_.close();
}

void add_onsets(file::CsvWriter& table, const SweepRequest& request, const std::vector<Onset>& onsets) {
    for (const Onset& o : onsets) {
        const measure::map::MapRow& row = request.rows[o.row];
        const bool good = o.found && !o.from_start;
        table.add(row.form->info->name)
            .add(row.format.name)
            .add(o.event)
            .add(o.statistic)
            .add(o.threshold)
            .add(std::string_view(o.from_last ? "last" : "first"))
            .add(o.found);
        table.add(good ? Cell(o.last_good) : Cell()).add(o.found ? Cell(o.first_bad) : Cell());
        table.add(good ? Cell(file::hex(o.last_good)) : Cell()).add(o.found ? Cell(file::hex(o.first_bad)) : Cell());
        table.add(o.found ? Cell(o.value_at_first_bad) : Cell()).add(o.recovers);
        const bool again = o.recovers && !o.good_at_end;
        table.add(o.recovers ? Cell(o.last_good_after) : Cell()).add(again ? Cell(o.bad_again) : Cell());
        table.add(o.recovers ? Cell(file::hex(o.last_good_after)) : Cell())
            .add(again ? Cell(file::hex(o.bad_again)) : Cell());
        const auto spread = o.spread();
        table.add(o.rays).add(o.views).add(1 + o.further.size()).add(spread.draws);
        for (const double x : {spread.low, spread.median, spread.high}) table.add(spread.draws > 0 ? Cell(x) : Cell());
        table.end_row();
    }
}

}  // namespace lostbits::output::sweep
