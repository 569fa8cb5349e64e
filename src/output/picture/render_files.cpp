#include "output/picture/render_files.hpp"

#include "output/map/row_names.hpp"
#include "output/picture/render_exr.hpp"
#include "output/picture/render_pictures.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::picture {

using measure::evaluate::TestedForm;
using measure::picture::RenderRequest;

namespace {

struct StageRow {
    scene::file::Stage stage;
    const TestedForm* row;
    const measure::picture::RenderSummary* summary;
};

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

struct RenderFiles::Parts {
    Parts(const RenderRequest& of, const RenderFilesOptions& with)
        : request(of),
          options(with),
          table(with.folder, "summary.csv", "One row per stage, form and format", stage_table()),
          pictures(of, with.folder / "contact.png", with.singles ? with.folder : std::filesystem::path()) {
        for (const TestedForm& row : of.rows)
            layers.emplace_back(with.folder / (map::row_name(row) + ".exr"), of, row, with.command);
    }

    const RenderRequest& request;
    RenderFilesOptions options;
    table::TableFile<StageRow> table;
    RenderPictures pictures;
    std::vector<RenderExr> layers;  ///< of each row
};

RenderFiles::RenderFiles(const RenderRequest& request, const RenderFilesOptions& options)
    : parts_(new Parts(request, options)) {}

RenderFiles::~RenderFiles() = default;

void RenderFiles::reference(int y0, int rows, std::span<const measure::picture::TruePixel> truth) {
    parts_->pictures.reference(y0, rows, truth);
}

void RenderFiles::row(std::size_t row, const measure::picture::RenderBand& band) {
    parts_->pictures.row(row, band);
    parts_->layers[row].write(band);
}

void RenderFiles::finish(const std::vector<measure::picture::RenderSummary>& summaries) {
    Parts& p = *parts_;
    for (RenderExr& exr : p.layers) exr.close();
    p.pictures.finish(summaries);
    const std::size_t stages = p.request.stages.size();
    for (std::size_t s = 0; s < stages; ++s)
        for (std::size_t r = 0; r < p.request.rows.size(); ++r)
            p.table.add({p.request.stages[s], &p.request.rows[r], &summaries[r * stages + s]});
    // Closed last: a folder with a summary is a finished one.
    table::close_tables(p.options.folder, p.request.scene->title, p.table);
}

}  // namespace lostbits::output::picture
