// Columns and rows of the tables of a map.
#include "output/map/map_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "measure/attribution/culprits.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::map {

using file::Cell;
using measure::evaluate::SummaryColumn;
using table::Table;
using table::when;

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

Cell cell_of(const SummaryColumn& column, const FormSummary& summary) {
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

void add_columns(Table<SummaryRow>& table, const std::vector<SummaryColumn>& columns) {
    for (const SummaryColumn& column : columns)
        table.add({{column.name, type_of(column), column.unit, column.meaning},
                   [column](const SummaryRow& row) { return cell_of(column, *row.summary); }});
}

std::string worst_ray_command(const SummaryRow& row, const measure::evaluate::WorstRay* ray) {
    const std::string arguments = ray != nullptr && ray->x >= 0 ? row.ray_arguments(*ray) : "";
    return arguments.empty() ? "" : attribution::explain_command(arguments, row.tested_form);
}

}  // namespace

Table<SummaryRow> make_summary_table(const std::vector<const Metric*>& metrics, const std::vector<Shape>& shapes,
                                     bool has_meshes, std::string group_column) {
    using R = SummaryRow;
    std::vector<SummaryColumn> ray_columns = measure::evaluate::make_summary_columns(metrics);
    std::erase_if(ray_columns, [has_meshes](const SummaryColumn& column) {
        return !column.is_in_tables || (column.only_for_meshes && !has_meshes);
    });

    // The row, the numbers of its rays, and the worst ray and the first wrong decision with their commands.
    Table<R> table;
    table.add(table::make_subject_columns(), &R::tested_form);
    add_columns(table, ray_columns);
    add_columns(table, measure::evaluate::make_worst_columns(shapes));
    table.add({"worst_explain", "the command that explains the worst ray and prints these numbers again",
               [](const R& r) { return worst_ray_command(r, &r.summary->worst); }});
    add_columns(table, measure::evaluate::make_wrong_decision_columns());
    table.add({"fault_explain", "the command that explains that ray",
               [](const R& r) { return worst_ray_command(r, r.summary->first_fault()); }});
    if (group_column.empty()) return table;

    // A column may have the name of a formula, or of a column of ours.
    group_column = file::escape_formula(group_column);
    while (table.find(group_column) != nullptr) group_column = "file_" + group_column;
    return Table<R>{{group_column, "value that the rays of this row have in that column; missing: all rays", &R::group}}
        .add(std::move(table));
}

std::vector<SummaryRow> make_summary_rows(std::size_t r, const TestedForm& tested_form, const FormSummary& summary,
                                          const measure::evaluate::Groups& groups, const RayArguments& ray_arguments) {
    std::vector<SummaryRow> rows{{tested_form, &summary, ray_arguments}};
    for (const measure::evaluate::Group& group : groups.all())
        rows.push_back(
            {tested_form, &group.summaries[r], ray_arguments, group.value.empty() ? "(empty)" : group.value});
    return rows;
}

std::vector<std::size_t> culprits_by_count(const std::vector<std::uint64_t>& counts) {
    std::vector<std::size_t> order;
    for (std::size_t c = 1; c < counts.size(); ++c) {
        if (counts[c] > 0) order.push_back(c);
    }
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
    return order;
}

table::Table<Culprit> make_culprit_table() {
    using R = Culprit;
    table::Table<R> table;
    table.add(table::make_subject_columns(), &R::tested_form);
    table.add(
        {{"operation",
          "expression of the operation; one axis stands for all three, and one iteration of a loop for all",
          &R::operation},
         {"culprit_rays", "rays whose culprit is this operation: correct hits, false hits and false misses", &R::rays},
         {"culprit_fraction", "1", "their share of the rays that have a culprit", &R::fraction}});
    return table;
}

bool asks_for_culprits(const std::vector<const Metric*>& metrics) {
    return std::ranges::any_of(metrics, &Metric::depends_on_forms);
}

std::vector<Culprit> find_culprits(const std::vector<const Metric*>& metrics, const TestedForm& tested_form,
                                   const FormSummary& summary) {
    const auto metric = std::ranges::find_if(metrics, &Metric::depends_on_forms);
    const auto& counts = summary.categories[metric - metrics.begin()];
    std::vector<Culprit> culprits;
    for (const std::size_t c : culprits_by_count(counts))
        culprits.push_back({tested_form, (*metric)->categories[c], counts[c],
                            measure::attribution::culprit_fraction(counts, std::array{c})});
    return culprits;
}

table::TableColumn<BandRay> outcome_column() {
    return {"outcome", "outcome of the ray", [](const BandRay& r) {
                return measure::answer::outcome_names[static_cast<std::size_t>(r.result->outcomes[r.i])];
            }};
}

Table<BandRay> make_truth_and_metric_columns(const std::vector<const Metric*>& metrics) {
    Table<BandRay> table;
    table.add_exact({"truth", "t", "t*, correctly rounded to binary64, in the same unit",
                     [](const BandRay& r) -> std::optional<double> {
                         if (!r.result->truth(r.i).is_hit()) return {};
                         return r.result->band->rounded_truth(r.i, binary64, r.tested_form->form->info->direction,
                                                              r.result->convention);
                     }});

    for (std::size_t m = 0; m < metrics.size(); ++m) {
        const auto categories = metrics[m]->categories;
        table.add({{measure::evaluate::column_name(*metrics[m]), categories.empty() ? "number" : "string",
                    std::string(metrics[m]->unit), std::string(metrics[m]->meaning)},
                   [m, categories](const BandRay& r) -> Cell {
                       const double value = r.result->metrics[m][r.i];
                       if (std::isnan(value)) return {};
                       if (categories.empty()) return value;
                       return categories[static_cast<std::size_t>(value)];
                   }});
    }
    return table;
}

Table<BandRay> make_pixel_table(const std::vector<const Metric*>& metrics) {
    using R = BandRay;
    Table<R> table{{"x", "pixel", "column, from the left",
                    [](const R& r) { return r.i % static_cast<std::size_t>(r.result->width); }},
                   {"y", "pixel", "row, from the top",
                    [](const R& r) {
                        const auto width = static_cast<std::size_t>(r.result->width);
                        return static_cast<std::size_t>(r.result->y0) + r.i / width;
                    }},
                   outcome_column(),
                   {"object", "primitive that the form hit, from 0",
                    [](const R& r) { return when(r.has_hit(), r.result->answers->primitive[r.i]); }},
                   {"truth_object", "primitive that the ray truly hits first, from 0", [](const R& r) {
                        const measure::truth::Truth& ray_truth = r.result->truth(r.i);
                        return when(ray_truth.is_hit(), ray_truth.primitive);
                    }}};
    table.add_exact(
        {"t", "t", "the form's answer, in its own unit", [](const R& r) { return when(r.has_hit(), r.t()); }});
    return table.add(make_truth_and_metric_columns(metrics));
}

}  // namespace lostbits::output::map
