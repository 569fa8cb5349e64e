#include "output/consistency/consistency_files.hpp"

#include <fmt/format.h>

#include "output/blame/explain_command.hpp"
#include "output/consistency/consistency_pictures.hpp"
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

struct AccordPixel {
    const ConsistencyBand* band;
    std::size_t i;
};

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

/// What a check finds of a row.
struct CheckRow {
    const Check* check;
    const TestedForm* row;
    const CheckSummary* summary;
};

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

struct ConsistencyFiles::Parts {
    Parts(const ConsistencyRequest& of, const ConsistencyFilesOptions& with)
        : request(of),
          options(with),
          table(with.folder, "summary.csv", "One row per check, form and format", check_table()),
          pictures(of, with.folder / "contact.png", with.singles ? with.folder : std::filesystem::path()) {
        if (!with.pixels_csv) return;
        for (const TestedForm& row : of.rows)
            pixels.push_back(std::make_unique<table::TableFile<AccordPixel>>(with.folder, map::row_name(row) + ".csv",
                                                                             "One row per pixel", pixel_table(of)));
    }

    const ConsistencyRequest& request;
    ConsistencyFilesOptions options;
    table::TableFile<CheckRow> table;
    ConsistencyPictures pictures;
    std::vector<std::unique_ptr<table::TableFile<AccordPixel>>> pixels;  ///< of each row, where they are asked for
};

ConsistencyFiles::ConsistencyFiles(const ConsistencyRequest& request, const ConsistencyFilesOptions& options)
    : parts_(new Parts(request, options)) {}

ConsistencyFiles::~ConsistencyFiles() = default;

void ConsistencyFiles::band(std::size_t row, const ConsistencyBand& band) {
    parts_->pictures.band(row, band);
    if (parts_->pixels.empty()) return;
    for (std::size_t i = 0; i < band.checks.front().accord.size(); ++i) parts_->pixels[row]->add({&band, i});
}

void ConsistencyFiles::finish(const std::vector<RowChecks>& rows) {
    Parts& p = *parts_;
    p.pictures.finish(rows);
    std::vector<file::DataResource> resources{p.table.about()};
    for (const auto& pixels : p.pixels) {
        pixels->close();
        resources.push_back(pixels->about());
    }
    for (std::size_t r = 0; r < rows.size(); ++r)
        for (std::size_t c = 0; c < rows[r].size(); ++c)
            p.table.add({p.request.checks[c], &p.request.rows[r], &rows[r][c]});
    file::write_datapackage(p.options.folder / "datapackage.json", p.request.scene->title, resources);
    p.table.close();  // last: a folder with a summary is a finished one
}

}  // namespace lostbits::output::consistency
