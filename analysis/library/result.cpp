#include "analysis/library/handles.hpp"

#include <algorithm>
#include <cmath>

#include "measure/evaluate/summary_columns.hpp"
#include "output/image/colour.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::analysis::library {

using measure::metric::Metric;
using output::file::Cell;
using output::file::Column;

namespace {

constexpr std::uint8_t no_category = 255;

template <class Names>
void append_names(ResultColumn& column, const Names& names) {
    for (const auto& name : names) column.names.emplace_back(name);
}

std::uint8_t to_code(double category) {
    return std::isnan(category) || category >= no_category ? no_category : static_cast<std::uint8_t>(category);
}

}  // namespace

ResultTable::ResultTable(std::string title, const std::vector<Column>& descriptions) : name(std::move(title)) {
    for (const Column& column : descriptions) columns.push_back({.description = column});
}

output::file::CsvWriter ResultTable::writer() {
    std::vector<Column> descriptions;
    for (const ResultColumn& column : columns) descriptions.push_back(column.description);
    return {descriptions, [this](std::size_t k, const Cell& cell) {
                ResultColumn& column = columns[k];
                if (column.description.type != "string") return column.numbers.push_back(cell.number());
                std::string text = cell.text();
                column.texts.push_back(text.empty() ? std::nullopt : std::optional(std::move(text)));
            }};
}

ResultColumn& ResultTable::operator[](const std::string& column) {
    return *std::ranges::find_if(columns, [&](const ResultColumn& c) { return c.description.name == column; });
}

std::size_t ResultTable::row_count() const {
    if (columns.empty()) return 0;
    const ResultColumn& first = columns.front();
    return std::max({first.numbers.size(), first.texts.size(), first.codes.size()});
}

void ResultTable::seal() {
    for (ResultColumn& column : columns) {
        for (const auto& text : column.texts) column.text_pointers.push_back(text ? text->c_str() : nullptr);
        for (const std::string& category : column.names) column.name_pointers.push_back(category.c_str());
    }
}

std::vector<Column> RayTable::columns(const std::vector<const Metric*>& metrics) {
    std::vector<Column> columns = output::map::make_pixel_table(metrics).columns();
    std::erase_if(columns, [](const Column& column) {
        return column.name == "x" || column.name == "y" || column.name == "t_hex" || column.name == "truth_hex";
    });
    return columns;
}

RayTable::RayTable(ResultTable& table, const measure::evaluate::TestedForm& tested_form,
                   const std::vector<const Metric*>& metrics)
    : table_(table), tested_form_(tested_form), metrics_(metrics) {
    append_names(table["outcome"], measure::answer::outcome_names);
    table["outcome"].colours = &output::image::outcome_colours.front().r;
    for (const Metric* m : metrics) append_names(table[measure::evaluate::column_name(*m)], m->categories);
}

std::deque<RayTable> add_ray_tables(lostbits_result& result, const CallSelection& chosen,
                                    const std::vector<measure::evaluate::TestedForm>& tested_forms,
                                    const std::vector<const Metric*>& metrics) {
    std::deque<RayTable> ray_tables;
    for (const measure::evaluate::TestedForm& tested_form : tested_forms) {
        if (chosen.arguments.rows == 0) break;
        ResultTable& table = result.tables.emplace_back(
            std::string(tested_form.form->info->name) + "." + std::string(tested_form.format.name),
            RayTable::columns(metrics));
        ray_tables.emplace_back(table, tested_form, metrics);
    }
    return ray_tables;
}

namespace {

/// The first columns of the table of a form. The columns of its metrics follow.
enum FixedColumn : std::size_t {
    outcome_column,
    primitive_column,
    true_primitive_column,
    t_column,
    true_t_column,
    fixed_columns
};

}  // namespace

void RayTable::add_band(const measure::evaluate::BandResult& result) {
    const std::size_t n = result.outcomes.size();
    auto& columns = table_.columns;
    for (std::size_t i = 0; i < n; ++i) {
        const bool is_hit = result.answers->hit[i] != 0;
        const measure::truth::Truth ray_truth = result.truth(i);
        columns[outcome_column].codes.push_back(static_cast<std::uint8_t>(result.outcomes[i]));
        columns[primitive_column].numbers.push_back(is_hit ? result.answers->primitive[i] : measure::truth::missing);
        columns[true_primitive_column].numbers.push_back(ray_truth.is_hit() ? ray_truth.primitive
                                                                            : measure::truth::missing);
        columns[t_column].numbers.push_back(is_hit ? result.answers->t[i] : measure::truth::missing);
        columns[true_t_column].numbers.push_back(
            ray_truth.is_hit()
                ? result.band->rounded_truth(i, binary64, tested_form_.form->info->direction, result.convention)
                : measure::truth::missing);
    }

    for (std::size_t m = 0; m < metrics_.size(); ++m) {
        ResultColumn& column = columns[fixed_columns + m];
        const std::vector<double>& values = result.metrics[m];
        if (column.names.empty()) column.numbers.insert(column.numbers.end(), values.begin(), values.end());
        else std::ranges::transform(values, std::back_inserter(column.codes), to_code);
    }
}

}  // namespace lostbits::analysis::library

using lostbits::analysis::library::ResultColumn;
using lostbits::analysis::library::ResultTable;

extern "C" {

int lostbits_result_table(const lostbits_result* result, size_t table, lostbits_table* into) {
    if (into == nullptr) return LOSTBITS_BAD_INPUT;
    if (result == nullptr || table >= result->tables.size()) return LOSTBITS_NOTHING;
    const ResultTable& found_table = result->tables[table];
    *into = {found_table.name.c_str(), found_table.columns.size(), found_table.row_count()};
    return LOSTBITS_OK;
}

int lostbits_result_column(const lostbits_result* result, size_t table, size_t column, lostbits_column* into) {
    if (into == nullptr) return LOSTBITS_BAD_INPUT;
    if (result == nullptr || table >= result->tables.size() || column >= result->tables[table].columns.size())
        return LOSTBITS_NOTHING;
    const ResultColumn& result_column = result->tables[table].columns[column];
    const bool is_coded = !result_column.names.empty(),
               is_text = !is_coded && result_column.description.type == "string";
    *into = {.name = result_column.description.name.c_str(),
             .type = result_column.description.type.c_str(),
             .unit = result_column.description.unit.c_str(),
             .meaning = result_column.description.meaning.c_str(),
             .numbers = is_coded || is_text ? nullptr : result_column.numbers.data(),
             .texts = is_text ? result_column.text_pointers.data() : nullptr,
             .categories = is_coded ? result_column.codes.data() : nullptr,
             .names = is_coded ? result_column.name_pointers.data() : nullptr,
             .name_count = result_column.names.size(),
             .colours = result_column.colours};
    return LOSTBITS_OK;
}

const char* lostbits_result_text(const lostbits_result* result, size_t text) {
    return result == nullptr || text >= result->texts.size() ? nullptr : result->texts[text].c_str();
}

void lostbits_result_free(lostbits_result* result) { delete result; }
}
