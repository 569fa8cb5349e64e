// Opens, fills and finishes the files of a map.
#include "output/map/map_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <optional>

#include "output/attribution/explain_command.hpp"
#include "output/file/machine.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_pictures.hpp"
#include "output/map/map_tables.hpp"
#include "output/pixel/form_files.hpp"

namespace lostbits::output::map {
namespace {

using MapFormWriter = pixel::FormFilesWriter<BandResult, BandRay>;

/// Preview of a tested form to which none of the metrics applies: the colours of its outcomes.
std::vector<image::Rgb8> outcome_colours_of(const BandResult& result) {
    std::vector<image::Rgb8> field(result.outcomes.size());
    std::ranges::transform(result.outcomes, field.begin(), pixel::colour_of);
    return field;
}

}  // namespace

struct MapWriter::Parts {
    const MapStudy& study;
    MapFilesOptions options;
    std::optional<MapPictures> pictures = {};
    std::deque<MapFormWriter> rows = {};
    std::optional<table::TableFile<SummaryRow>> summary = {};
    std::optional<table::TableFile<Culprit>> culprits = {};

    [[nodiscard]] table::Table<SummaryRow> make_summary_columns() const {
        auto table = make_summary_table(study.metrics, study.scene->shapes(), study.scene->mesh != nullptr,
                                        options.group_column);
        if (!options.is_list) return table;
        for (auto& column : table)
            if (column.about.unit == "pixel") column.about.unit = "";
        table.set_meaning("rays", "number of rays in the file");
        table.set_meaning("worst_x", "index in the file, from 0, of the ray with the largest |ulp_error|");
        table.set_meaning("worst_y", "0");
        return table;
    }
    void add_row(std::size_t r) {
        const TestedForm& tested_form = study.tested_forms[r];
        std::unique_ptr<table::TableFile<BandRay>> pixels;
        if (options.writes_pixels_csv)
            pixels = std::make_unique<table::TableFile<BandRay>>(
                options.keep_piece ? "" : options.folder, tested_form_name(tested_form) + ".csv",
                fmt::format("One row per pixel: {} in {}", tested_form.form->info->name, tested_form.format.name),
                make_pixel_table(study.metrics));

        // The functions that turn a band into rows of the table and of the EXR.
        MapFormWriter::Functions functions{
            .add_pixel =
                [&tested_form](table::TableFile<BandRay>& file, const BandResult& band, std::size_t i) {
                    file.add({&band, i, &tested_form});
                },
            .pixels = [](const BandResult& band) { return band.outcomes.size(); }};
        pixel::BandFiles<BandResult> files{pictures->files(), {}, options.keep_piece};

        if (MapExr* const exr = options.exr) {
            functions.exr_scanlines = [&tested_form, exr](const BandResult& band,
                                                          std::span<const image::Rgb8> preview) {
                return preview.empty() ? exr->make_rows(tested_form, band, outcome_colours_of(band))
                                       : exr->make_rows(tested_form, band, preview);
            };
            files.write_exr = [exr](const std::vector<ExrScanlines>& pieces) { exr->write(pieces); };
        }
        rows.emplace_back(r, files, std::move(functions), std::move(pixels));
    }
};

MapWriter::MapWriter(const MapStudy& study, const MapFilesOptions& options)
    : parts_(new Parts{.study = study, .options = options}) {
    Parts& p = *parts_;
    // The limit on open files is checked before an hour of work is spent.
    const std::size_t files_per_row =
        (options.draws_single_pictures ? options.drawn_metrics.size() : 0) + (options.writes_pixels_csv ? 1 : 0);
    file::require_open_files(study.tested_forms.size() * files_per_row + options.drawn_metrics.size() + 2,
                             options.folder.string(), "select fewer forms, formats or metrics");

    // A shard and the sheet of a claim have no tables.
    const bool has_tables = !options.keep_piece && options.sheet_only_file.empty();
    if (has_tables)
        p.summary.emplace(
            options.folder, "summary.csv",
            options.group_column.empty() ? "One row per form and format" : "One row per form, format and group",
            p.make_summary_columns());
    if (has_tables && asks_for_culprits(study.metrics))
        p.culprits.emplace(options.folder, "culprits.csv", "One row per form, format and operation that is a culprit",
                           make_culprit_table());

    p.pictures.emplace(study, p.options);
    for (std::size_t r = 0; r < study.tested_forms.size(); ++r) p.add_row(r);
}

MapWriter::~MapWriter() = default;

measure::evaluate::ShowForms MapWriter::show() { return measure::evaluate::show_to_each(parts_->rows); }

void MapWriter::put(std::size_t form_index, pixel::Piece&& piece) { parts_->rows.at(form_index).write_piece(piece); }

void MapWriter::finish(const std::vector<FormSummary>& summaries, const measure::evaluate::Groups& groups) {
    Parts& p = *parts_;
    p.pictures->finish(summaries);
    if (!p.summary) return;

    const auto ray_arguments = [&p](const measure::evaluate::WorstRay& ray) {
        return p.options.ray_arguments
                   ? p.options.ray_arguments(ray)
                   : attribution::explain_pixel_arguments(p.options.scene_arguments, static_cast<int>(ray.x), ray.y);
    };
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        p.summary->add_all(make_summary_rows(r, p.study.tested_forms[r], summaries[r], groups, ray_arguments));
        if (p.culprits) p.culprits->add_all(find_culprits(p.study.metrics, p.study.tested_forms[r], summaries[r]));
    }

    // The summary is closed last, because a folder that has one is complete.
    if (p.options.exr) p.options.exr->close();
    table::close_tables(p.options.folder, p.study.scene->title, *p.summary, p.culprits, p.rows, p.options.other_tables);
}

}  // namespace lostbits::output::map
