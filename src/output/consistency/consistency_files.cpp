#include "output/consistency/consistency_files.hpp"

#include <fmt/format.h>

#include "output/blame/explain_command.hpp"
#include "output/map/row_names.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::consistency {

using measure::consistency::accord_names;
using measure::consistency::AccordOfPixels;
using measure::consistency::Check;
using measure::consistency::CheckSummary;
using measure::consistency::ConsistencyBand;
using measure::consistency::ConsistencyRequest;
using measure::consistency::RowChecks;
using measure::evaluate::TestedForm;
using table::Table;

namespace {

Table<AccordPixel> pixel_table(const ConsistencyRequest& request) {
    using R = AccordPixel;
    std::string known;
    for (const std::string_view name : accord_names) known += fmt::format("{}{}", known.empty() ? "" : ", ", name);
    Table<R> table{
        {"x", "integer", "", "column of the pixel", [](const R& r) { return static_cast<int>(r.i) % r.band->width; }},
        {"y", "integer", "", "row of the pixel",
         [](const R& r) { return r.band->y0 + static_cast<int>(r.i) / r.band->width; }}};
    for (std::size_t c = 0; c < request.checks.size(); ++c) {
        const Check& check = *request.checks[c];
        table.add({std::string(check.name), "string", "", fmt::format("{}: {}", check.title, known),
                   [c](const R& r) { return accord_names[static_cast<std::size_t>(r.band->checks[c].accord[r.i])]; }});
        if (!check.numbers) continue;
        const auto number = [c](std::vector<double> AccordOfPixels::*numbers) {
            return [c, numbers](const R& r) {
                const AccordOfPixels& pixels = r.band->checks[c];
                return pixels.excess.empty() ? file::Cell() : file::number_or_missing((pixels.*numbers)[r.i]);
            };
        };
        table.add({{fmt::format("{}_apart", check.name), "number", "ulp",
                    "|near + far from the other end - length| in ulps of the length", number(&AccordOfPixels::apart)},
                   {fmt::format("{}_excess", check.name), "number", "ulp", "how far that is from the exact sum",
                    number(&AccordOfPixels::excess)}});
    }
    return table;
}

Table<CheckRow> check_table() {
    using R = CheckRow;
    Table<R> table{{"check", "string", "", "which questions are compared: a row of the checks",
                    [](const R& r) { return r.check->name; }}};
    table.add(table::subject_columns("form that is asked", "format that everything is computed in"), &R::row);
    for (const auto& column : measure::consistency::consistency_columns())
        table.add(table::measured_column<R>(column, [](const auto& c, const R& r) { return c.value(*r.summary); }));
    const auto explain = [](auto ray) {
        return [ray](const R& r) {
            const auto& shown = r.summary->shown;
            return shown && !(shown->rays.*ray).solids.empty()
                       ? blame::explain_command(blame::name_of_ray(&(shown->rays.*ray)), *r.row)
                       : std::string();
        };
    };
    using Rays = decltype(CheckSummary{}.shown->rays);
    return table.add(
        {{"first_x", "integer", "", "column of the first pixel that the form is to blame for",
          [](const R& r) { return r.summary->shown ? file::Cell(r.summary->shown->x) : file::Cell(); }},
         {"first_y", "integer", "", "its row",
          [](const R& r) { return r.summary->shown ? file::Cell(r.summary->shown->y) : file::Cell(); }},
         {"first_explain", "string", "", "command that explains the ray of the first question there",
          explain(&Rays::first)},
         {"second_explain", "string", "", "command that explains the ray of the second", explain(&Rays::second)}});
}

}  // namespace

ConsistencyFiles::ConsistencyFiles(const ConsistencyRequest& request, ConsistencyFilesOptions options)
    : request_(request),
      options_(std::move(options)),
      table_(options_.folder, "summary.csv", "One row per check, form and format", check_table()),
      pictures_(request, options_.folder / "contact.png", options_.singles ? options_.folder : "") {
    if (!options_.pixels_csv) return;
    for (const TestedForm& row : request.rows)
        pixels_.push_back(std::make_unique<table::TableFile<AccordPixel>>(options_.folder, map::row_name(row) + ".csv",
                                                                          "One row per pixel", pixel_table(request)));
}

void ConsistencyFiles::band(std::size_t row, const ConsistencyBand& band) {
    pictures_.band(row, band);
    if (pixels_.empty()) return;
    for (std::size_t i = 0; i < band.checks.front().accord.size(); ++i) pixels_[row]->add({&band, i});
}

void ConsistencyFiles::finish(const std::vector<RowChecks>& rows) {
    pictures_.finish(rows);
    std::vector<file::DataResource> resources{table_.about()};
    for (const auto& pixels : pixels_) {
        pixels->close();
        resources.push_back(pixels->about());
    }
    for (std::size_t r = 0; r < rows.size(); ++r)
        for (std::size_t c = 0; c < rows[r].size(); ++c)
            table_.add({request_.checks[c], &request_.rows[r], &rows[r][c]});
    file::write_datapackage(options_.folder / "datapackage.json", request_.scene->title, resources);
    table_.close();  // last: a folder with a summary is a finished one
}

}  // namespace lostbits::output::consistency
