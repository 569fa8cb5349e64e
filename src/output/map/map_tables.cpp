#include "output/map/map_tables.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "output/blame/explain_command.hpp"
#include "output/file/machine.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::map {

using file::Cell;
using file::Column;
using measure::map::SummaryColumn;
using measure::metric::Metric;

namespace {

std::string type_of(const SummaryColumn& column) {
    switch (column.kind) {
        case SummaryColumn::Kind::count: return "integer";
        case SummaryColumn::Kind::number: return "number";
        case SummaryColumn::Kind::hex:
        case SummaryColumn::Kind::category: break;
    }
    return "string";
}

Cell cell_of(const SummaryColumn& column, const measure::map::MapSummary& summary) {
    const double x = column.value(summary);
    if (std::isnan(x)) return {};
    switch (column.kind) {
        case SummaryColumn::Kind::count: return static_cast<std::uint64_t>(x);
        case SummaryColumn::Kind::number: break;
        case SummaryColumn::Kind::hex: return file::hex(x);
        case SummaryColumn::Kind::category: return column.categories[static_cast<std::size_t>(x)];
    }
    return x;
}

}  // namespace

SummaryTable::SummaryTable(const std::vector<const Metric*>& metrics, const std::vector<Shape>& shapes, bool meshes,
                           std::string by)
    : by_(std::move(by)), columns_(measure::map::summary_columns(metrics)) {
    std::erase_if(columns_, [meshes](const SummaryColumn& c) { return !c.tabled || (c.of_meshes && !meshes); });
    std::ranges::move(measure::map::worst_columns(shapes), std::back_inserter(columns_));
    fault_columns_ = measure::map::fault_columns();
    if (by_.empty()) return;
    by_ = file::csv_text(by_);  // a column may be called like a formula, or like one of ours
    const auto own = columns();
    while (std::ranges::count(own, by_, &Column::name) > 1) by_ = "file_" + by_;
}

std::vector<Column> SummaryTable::columns() const {
    std::vector<Column> columns;
    if (!by_.empty()) columns.push_back({by_, "string", "", "what the rays of this row have there; missing: all rays"});
    columns.push_back({"form", "string", "", "form under test"});
    columns.push_back({"format", "string", "", "format it computes in"});
    for (const SummaryColumn& c : columns_) columns.push_back({c.name, type_of(c), c.unit, c.meaning});
    columns.push_back({"worst_explain", "string", "", "the command that explains the worst ray: these numbers again"});
    for (const SummaryColumn& c : fault_columns_) columns.push_back({c.name, type_of(c), c.unit, c.meaning});
    columns.push_back({"fault_explain", "string", "", "the command that explains that ray"});
    return columns;
}

void SummaryTable::add(file::CsvWriter& csv, const measure::map::MapRow& row, const measure::map::MapSummary& summary,
                       const NameOfRay& name_of_ray) const {
    const auto command = [&](const measure::map::WorstRay* ray) -> Cell {
        const std::string name = ray != nullptr && ray->x >= 0 ? name_of_ray(*ray) : "";
        if (name.empty()) return {};
        return blame::explain_command(name, row);
    };
    csv.add(row.form->info->name).add(row.format.name);
    for (const SummaryColumn& c : columns_) csv.add(cell_of(c, summary));
    csv.add(command(&summary.worst));
    for (const SummaryColumn& c : fault_columns_) csv.add(cell_of(c, summary));
    csv.add(command(summary.fault()));
}

void SummaryTable::add_all(file::CsvWriter& csv, std::size_t r, const measure::map::MapRow& row,
                           const measure::map::MapSummary& summary, const measure::map::Groups& groups,
                           const NameOfRay& name_of_ray) const {
    if (!by_.empty()) csv.add(Cell());
    add(csv, row, summary, name_of_ray);
    csv.end_row();
    for (const measure::map::Group& group : groups.all()) {
        csv.add(group.value.empty() ? "(empty)" : group.value);
        add(csv, row, group.summaries[r], name_of_ray);
        csv.end_row();
    }
}

std::vector<Column> pixel_columns(const measure::map::MapRequest& request) {
    std::vector<Column> columns{{"x", "integer", "pixel", "column, from the left"},
                                {"y", "integer", "pixel", "row, from the top"},
                                {"outcome", "string", "", "outcome of the ray"},
                                {"object", "integer", "", "solid that the form hit, from 0"},
                                {"truth_object", "integer", "", "solid that the ray truly hits first, from 0"},
                                {"t", "number", "t", "the form's answer, in its own unit"},
                                {"t_hex", "string", "t", "the same, exactly"},
                                {"truth", "number", "t", "t*, correctly rounded to binary64, in the same unit"},
                                {"truth_hex", "string", "t", "the same, exactly"}};
    for (const Metric* m : request.metrics)
        columns.push_back({measure::map::column_name(*m), m->categories.empty() ? "number" : "string",
                           std::string(m->unit), std::string(m->meaning)});
    return columns;
}

void write_pixels(file::CsvWriter& csv, const measure::map::MapRequest& request, const measure::map::MapRow& row,
                  const measure::map::BandResult& result) {
    for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
        const auto width = static_cast<std::size_t>(result.width);
        csv.add(i % width).add(static_cast<std::size_t>(result.y0) + i / width);
        csv.add(measure::answer::outcome_names[static_cast<std::size_t>(result.outcomes[i])]);
        const bool hit = result.answers->hit[i] != 0;
        const measure::truth::Truth& truth = result.truth(i);
        csv.add(hit ? Cell(result.answers->object[i]) : Cell()).add(truth.is_hit() ? Cell(truth.object) : Cell());
        const auto exact = [&](bool there, double x) {
            csv.add(there ? Cell(x) : Cell()).add(there ? Cell(file::hex(x)) : Cell());
        };
        exact(hit, result.answers->t[i]);
        exact(
            truth.is_hit(),
            truth.is_hit() ? result.band->rounded_truth(i, binary64, row.form->info->direction, result.convention) : 0);
        for (std::size_t m = 0; m < request.metrics.size(); ++m) {
            const double value = result.metrics[m][i];
            const auto categories = request.metrics[m]->categories;
            csv.add(std::isnan(value)    ? Cell()
                    : categories.empty() ? Cell(value)
                                         : Cell(categories[static_cast<std::size_t>(value)]));
        }
        csv.end_row();
    }
}

void require_open_files(const measure::map::MapRequest& request, std::size_t pictures, bool pixels_csv,
                        const std::filesystem::path& folder) {
    // In front of an hour of drawing titles.
    file::require_open_files(request.rows.size() * (pictures + (pixels_csv ? 1 : 0)) + pictures + 2, folder.string(),
                             "select fewer forms, formats or metrics");
}

}  // namespace lostbits::output::map
