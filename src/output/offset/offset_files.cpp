#include "output/offset/offset_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/table/shared_columns.hpp"

namespace lostbits::output::offset {

using measure::offset::both_sides;
using measure::offset::Fault;
using measure::offset::OffsetBand;
using measure::offset::OffsetRequest;
using measure::offset::OffsetRow;
using measure::offset::OffsetSummary;
using measure::offset::Side;
using measure::offset::Strategy;
using table::Table;

namespace {

Table<OffsetPixel> pixel_table(const OffsetRequest& request) {
    using R = OffsetPixel;
    Table<R> table{
        {"x", "integer", "", "column of the pixel", [](const R& r) { return static_cast<int>(r.i) % r.band->width; }},
        {"y", "integer", "", "row of the pixel",
         [](const R& r) { return r.band->y0 + static_cast<int>(r.i) / r.band->width; }},
        {"object", "integer", "", "the solid that is left, from 0", [](const R& r) { return r.band->object[r.i]; }}};
    for (const Side side : both_sides) {
        const std::string name(name_of(side));
        using P = measure::offset::SideOfPoint;
        table.add<P>(
            {{"rays_" + name, "integer", "", "rays " + in_words(side), &P::rays},
             {"safe_" + name, "number", "world units", "smallest safe offset; inf where none is", &P::safe},
             {"quiet_" + name, "number", "world units",
              "smallest offset that is safe by truth and by the form's arithmetic; inf where none is", &P::quiet}},
            [side](const R& r) -> const P& { return r.band->sides[r.i][static_cast<std::size_t>(side)]; });
        for (std::size_t k = 0; k < request.strategies.size(); ++k) {
            const Strategy& s = *request.strategies[k];
            const std::string rays = "rays of " + std::string(s.name);
            table.add(
                {{short_name(s) + "_self_hits_" + name, "integer", "", rays + " that meet by truth what they leave",
                  [side, k](const R& r) { return r.band->at(r.i, side, k)[Fault::self_hit]; }},
                 {short_name(s) + "_bad_" + name, "integer", "",
                  rays + " with any fault but a start on the wrong side, which alone harms nothing",
                  [side, k](const R& r) { return r.band->at(r.i, side, k).bad; }}});
        }
    }
    return table;
}

}  // namespace

Table<StrategyRow> strategy_table() {
    using R = StrategyRow;
    Table<R> table{
        {"strategy", "string", "", "how the new origin is made: a row of the table of strategies",
         [](const R& r) { return r.strategy->name; }},
        {"side", "string", "", "where the new rays go: outside (light, mirror, hemisphere) or inside (refraction)",
         [](const R& r) { return name_of(r.side); }},
        {"point", "string", "", "what is left: the point as computed, or put back onto the surface (projected)",
         [](const R& r) { return name_of(r.row->point); }}};
    table.add(
        table::subject_columns("form that finds the points, and that is asked for self-hits",
                               "format that everything is computed in"),
        [](const R& r) -> const auto& { return r.row->row; });
    table.add({"operations", "integer", "", "operations that one new ray costs, as the strategy is written",
               [](const R& r) { return r.strategy->operations(r.row->row.form->shape); }});
    for (const auto& column : measure::offset::offset_columns())
        table.add(table::measured_column<R>(
            column, [](const auto& c, const R& r) { return c.value(*r.summary, r.side, r.place); }));
    return table;
}

std::vector<StrategyRow> strategy_rows(const OffsetRequest& request, const std::vector<OffsetSummary>& summaries) {
    std::vector<StrategyRow> rows;
    for (std::size_t r = 0; r < request.rows.size(); ++r)
        for (const Side side : both_sides)
            for (std::size_t k = 0; k < request.strategies.size(); ++k)
                rows.push_back({&request.rows[r], &summaries[r], side, request.strategies[k], k});
    return rows;
}

OffsetFiles::OffsetFiles(const OffsetRequest& request, OffsetFilesOptions options)
    : request_(request),
      options_(std::move(options)),
      table_(options_.folder, "summary.csv", "One row per strategy, side, kind of point, form and format",
             strategy_table()),
      pictures_(request, options_.folder / "contact.png", options_.singles ? options_.folder : "") {
    if (!options_.pixels_csv) return;
    for (const OffsetRow& row : request.rows)
        pixels_.push_back(std::make_unique<table::TableFile<OffsetPixel>>(options_.folder, row_name(row) + ".csv",
                                                                          "One row per pixel with a point that counts",
                                                                          pixel_table(request)));
}

void OffsetFiles::band(std::size_t row, const OffsetBand& band) {
    pictures_.band(row, band);
    if (pixels_.empty()) return;
    for (std::size_t i = 0; i < band.is_point.size(); ++i)
        if (band.is_point[i] != 0) pixels_[row]->add({&band, i});
}

void OffsetFiles::finish(const std::vector<OffsetSummary>& summaries) {
    pictures_.finish(summaries);
    std::vector<file::DataResource> resources{table_.about()};
    for (const auto& pixels : pixels_) {
        pixels->close();
        resources.push_back(pixels->about());
    }
    resources.insert(resources.end(), options_.also.begin(), options_.also.end());
    table_.add_all(strategy_rows(request_, summaries));
    file::write_datapackage(options_.folder / "datapackage.json", request_.scene->title, resources);
    table_.close();  // last: a folder with a summary is a finished one
}

}  // namespace lostbits::output::offset
