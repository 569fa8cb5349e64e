// Files of a study of one scene: the contact sheet and its pictures, a table with one row per pixel, an EXR of each
// tested form (a form in a format), and summary.csv. A presentation describes the files. It is a struct with these
// members:
//
//   Study, SummaryRow                     the study, and a row of its summary.csv
//   summary_title, make_summary_table(), make_summary_rows(study, summaries)
//   file_stem(study, form_index)          the stem of the files of a row
//   pixels(band)                          the number of pixels of a band
//   columns(study), sheet(study)          pictures of pixels, and the sheet that shows them
//   notes(study, summaries)               the texts below the cells of the sheet
//   pixel_title, make_pixel_table(study)  optional. `has_row(band, i)`, also optional: false for a pixel without a row
//   layers(study), make_exr_spec(study, row, command)   optional: the EXR of a row
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/study/study.hpp"
#include "output/image/exr_book.hpp"
#include "output/pixel/exr_layers.hpp"
#include "output/pixel/form_files.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::study {

/// A pixel of a band, for the table of pixels.
template <class Band>
struct PixelInBand {
    const Band* band;
    std::size_t i;
};

/// The columns x and y of a pixel.
template <class Band>
table::Table<PixelInBand<Band>> position_columns() {
    using R = PixelInBand<Band>;
    return {{"x", "column of the pixel", [](const R& r) { return static_cast<int>(r.i) % r.band->width; }},
            {"y", "row of the pixel", [](const R& r) { return r.band->y0 + static_cast<int>(r.i) / r.band->width; }}};
}

/// A text below a cell of the sheet, and the position of the cell.
struct Note {
    pixel::SheetPosition position;
    std::string text;
};

/// Writes the files of a study as its presentation describes them. Opens all files before the work starts; `finish`
/// gives them their final names.
template <class Presentation>
class StudyWriter {
public:
    using Study = typename Presentation::Study;
    using Band = typename Study::Band;

    /// `study` must outlive the object. If `keep_piece` is set, it receives the pieces of a shard, and no file is
    /// opened.
    StudyWriter(const Study& study, pixel::SceneFilesOptions options, pixel::PieceReceiver keep_piece = {})
        : study_(study),
          options_(std::move(options)),
          keep_piece_(std::move(keep_piece)),
          pictures_({.scene = study.scene,
                     .sheets = {Presentation::sheet(study, options_.sheet())},
                     .single_picture_folder = options_.folder_of_single_pictures(),
                     .stop = study.limit.stop,
                     .opens_files = !keep_piece_},
                    Presentation::columns(study)) {
        if (!keep_piece_)
            table_.emplace(options_.folder, "summary.csv", Presentation::summary_title,
                           Presentation::make_summary_table());
        for (std::size_t r = 0; r < study.tested_forms.size(); ++r) add_form(r);
    }
    StudyWriter(const StudyWriter&) = delete;
    StudyWriter& operator=(const StudyWriter&) = delete;

    /// Returns the function that receives the bands of the study.
    [[nodiscard]] measure::study::ShowBand<Study> show() {
        return [this](std::size_t form_index, const Band& band) { forms_[form_index].add_band(band); };
    }
    /// Writes the next piece of a row, which another run (a shard) kept.
    void put(std::size_t form_index, pixel::Piece&& piece) { forms_.at(form_index).write_piece(piece); }

    void finish(const std::vector<typename Study::Summary>& summaries) {
        for (const auto& book : books_) book->close();
        for (Note& note : Presentation::notes(study_, summaries))
            pictures_.writer().set_note(note.position, std::move(note.text));
        pictures_.writer().finish();
        if (options_.folder.empty()) return;
        table_->add_all(Presentation::make_summary_rows(study_, summaries));
        table::close_tables(options_.folder, study_.scene.title, *table_, forms_, options_.other_tables);
    }

private:
    using Pixel = PixelInBand<Band>;
    using FormWriter = pixel::FormFilesWriter<Band, Pixel>;

    void add_form(std::size_t r) {
        typename FormWriter::Functions functions{.pixels = Presentation::pixels};
        pixel::BandFiles<Band> files{pictures_, {}, keep_piece_};

        // The table of pixels, if the presentation has one and it is asked for.
        std::unique_ptr<table::TableFile<Pixel>> table;
        if constexpr (requires { Presentation::make_pixel_table(study_); }) {
            if (options_.writes_pixels_csv)
                table = std::make_unique<table::TableFile<Pixel>>(
                    keep_piece_ ? "" : options_.folder, Presentation::file_stem(study_, r) + ".csv",
                    Presentation::pixel_title, Presentation::make_pixel_table(study_));
            functions.add_pixel = [](table::TableFile<Pixel>& file, const Band& band, std::size_t i) {
                if constexpr (requires { Presentation::has_row(band, i); })
                    if (!Presentation::has_row(band, i)) return;
                file.add({&band, i});
            };
        }

        if constexpr (requires { Presentation::layers(study_); }) {
            if (!options_.folder.empty()) add_exr(r, functions, files);
        }
        forms_.emplace_back(r, files, std::move(functions), std::move(table));
    }

    void add_exr(std::size_t r, typename FormWriter::Functions& functions, pixel::BandFiles<Band>& files) {
        const auto layers = std::make_shared<const pixel::ExrLayers<Band>>(Presentation::layers(study_));
        functions.exr_scanlines = [layers](const Band& band, std::span<const image::Rgb8>) {
            return std::vector{
                pixel::ExrScanlines{0, band.y0, band.scanlines, layers->samples(band, Presentation::pixels(band))}};
        };
        if (keep_piece_) return;
        books_.push_back(std::make_unique<image::ExrBook>(
            options_.folder / (Presentation::file_stem(study_, r) + ".exr"),
            std::vector{
                image::ExrPart{"", Presentation::make_exr_spec(study_, r, layers->channels(), options_.command)}}));
        files.write_exr = [book = books_.back().get()](const std::vector<pixel::ExrScanlines>& pieces) {
            for (const pixel::ExrScanlines& piece : pieces)
                book->write_rows(piece.part, piece.y0, piece.rows, std::as_bytes(std::span(piece.samples)));
        };
    }

    const Study& study_;
    pixel::SceneFilesOptions options_;
    pixel::PieceReceiver keep_piece_;
    pixel::PictureWriter<Band> pictures_;
    std::optional<table::TableFile<typename Presentation::SummaryRow>> table_;  ///< none in a shard
    std::deque<FormWriter> forms_;
    std::vector<std::unique_ptr<image::ExrBook>> books_;  ///< one for each row, if the study has an EXR
};

}  // namespace lostbits::output::study
