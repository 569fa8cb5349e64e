#include "output/picture/render_files.hpp"

#include "output/map/row_names.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::picture {

using measure::evaluate::TestedForm;
using measure::picture::RenderRequest;

namespace {

table::Table<StageRow> stage_table() {
    using R = StageRow;
    table::Table<R> table{{"stage", "string", "", "how far the picture goes: visible, diffuse, shadows, phong",
                           [](const R& r) { return name_of(r.stage); }}};
    table.add(table::subject_columns("form that finds hits and shadows", "format that everything is computed in"),
              &R::row);
    for (const auto& column : measure::picture::render_columns())
        table.add(table::measured_column<R>(column, [](const auto& c, const R& r) { return c.value(*r.summary); }));
    return table;
}

}  // namespace

RenderFiles::RenderFiles(const RenderRequest& request, RenderFilesOptions options)
    : request_(request),
      options_(std::move(options)),
      table_(options_.folder, "summary.csv", "One row per stage, form and format", stage_table()),
      pictures_(request, options_.folder / "contact.png", options_.singles ? options_.folder : "") {
    for (const TestedForm& row : request.rows)
        layers_.emplace_back(options_.folder / (map::row_name(row) + ".exr"), request, row, options_.command);
}

void RenderFiles::finish(const std::vector<measure::picture::RenderSummary>& summaries) {
    for (RenderExr& exr : layers_) exr.close();
    pictures_.finish(summaries);
    const std::size_t stages = request_.stages.size();
    for (std::size_t s = 0; s < stages; ++s)
        for (std::size_t r = 0; r < request_.rows.size(); ++r)
            table_.add({request_.stages[s], &request_.rows[r], &summaries[r * stages + s]});
    // Closed last: a folder with a summary is a finished one.
    table::close_tables(options_.folder, request_.scene->title, table_);
}

}  // namespace lostbits::output::picture
