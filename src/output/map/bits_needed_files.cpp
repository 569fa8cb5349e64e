// Draws and tabulates the significand bits that each form needs.
#include "output/map/bits_needed_files.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "measure/metric/statistics.hpp"
#include "output/map/map_colour.hpp"
#include "output/pixel/columns.hpp"
#include "output/pixel/form_files.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::map {

using intersect::Info;
using measure::evaluate::BitsNeededStudy;
using measure::evaluate::BitsNeededSummary;
using measure::evaluate::PrecisionCounts;
using measure::metric::statistics;
using table::Table;
using table::when;

namespace {

std::string file_stem(const Info& form) { return std::string(form.name) + ".needed"; }

/// Colours of the width (number of significand bits) that a pixel needs, and of pixels without a width on the scale.
pixel::Look needed_look() {
    using measure::evaluate::min_precision, measure::evaluate::max_precision;
    return {{{""},
             {fmt::format("not even {} bits are enough", max_precision), beyond_colour},
             {outcome_in_words(Outcome::unresolved), pixel::colour_of(Outcome::unresolved)}},
            image::ColourScale("viridis", image::image_backend().ramp("viridis", 256), min_precision, max_precision),
            "bits"};
}

pixel::PixelValue pixel_of(double needed) {
    if (std::isnan(needed)) return {2};
    return needed == measure::evaluate::beyond_max_precision ? pixel::PixelValue{1} : pixel::PixelValue{0, needed};
}

using BitsNeededPictures = pixel::PictureWriter<BitsNeededBand>;

/// Picture of the form with the index `form_index` in the study.
pixel::DrawnColumn<BitsNeededBand> make_picture(const BitsNeededStudy& study, std::size_t form_index,
                                                std::shared_ptr<const pixel::Look> look) {
    const Info& form = *study.tested_forms[form_index]->info;
    return {{.file = file_stem(form) + ".png",
             .title = fmt::format("{}: significand bits needed for {} correct {}", form.name, study.correct_bits,
                                  study.correct_bits == 1 ? "bit" : "bits"),
             .subtitle = {std::string(form.title),
                          fmt::format("colour: the smallest width from which on every width up to {} decides correctly "
                                      "and, on a hit, keeps {} correct bits; inputs are rounded to this width too",
                                      measure::evaluate::max_precision, study.correct_bits)},
             .look = std::move(look)},
            form_index,
            pixel::make_draw_function<BitsNeededBand>(
                [](const BitsNeededBand& band, std::size_t i) { return pixel_of(band.bits_needed[i]); })};
}

/// Makes one picture per form.
BitsNeededPictures make_pictures(const BitsNeededStudy& study, const BitsNeededFilesOptions& options) {
    const auto look = std::make_shared<const pixel::Look>(needed_look());
    std::vector<pixel::DrawnColumn<BitsNeededBand>> columns;
    for (std::size_t r = 0; r < study.tested_forms.size(); ++r) columns.push_back(make_picture(study, r, look));
    return {{.scene = study.scene,
             .sheets = {},
             .single_picture_folder = options.folder,
             .stop = study.limit.stop,
             .opens_files = !options.keep_piece},
            std::move(columns)};
}

struct BitsNeededRow {
    std::string_view form;
    int bits;
    const BitsNeededSummary* summary;
    PrecisionCounts widths;
};

Table<BitsNeededRow> make_bits_needed_table() {
    using R = BitsNeededRow;
    Table<R> table{{"form", "form under test", &R::form},
                   {"bits_asked", "bits",
                    "correct bits that are asked for, B: the answer must be within half an ulp of a format with B "
                    "significand bits",
                    &R::bits},
                   {"pixels", "rays, one per pixel", [](const R& r) { return r.summary->pixel_count(); }}};

    // Statistics of the widths, over all pixels that have one and over the true hits.
    const auto add = [&table](const std::string& prefix, const char* population, const auto& counts_of) {
        for (const measure::metric::Statistic& statistic : statistics)
            table.add({prefix + std::string(statistic.name), "bits", std::string(statistic.meaning) + population,
                       [statistic, counts_of](const R& r) {
                           const PrecisionCounts& counts = counts_of(r);
                           return when(counts.count() != 0, static_cast<double>(statistic.of(counts)));
                       }});
    };
    add(
        "needed_", " of the widths needed, over the pixels that have one",
        [](const R& r) -> const auto& { return r.widths; });
    add(
        "hit_needed_", " of the widths needed, over the rays that truly hit",
        [](const R& r) -> const auto& { return r.summary->hits; });

    // Pixels without a width.
    using S = BitsNeededSummary;
    return table.add<S>(
        {{"hits_beyond_53", "rays that truly hit and for which not even 53 bits suffice", &S::hits_beyond},
         {"misses_beyond_53", "rays that truly miss but that the form hits even with 53 bits", &S::misses_beyond},
         {"unresolved", "rays whose truth was not proved within the stated limit", &S::unresolved}},
        &R::summary);
}

struct BitsNeededPixel {
    const BitsNeededBand* band;
    std::size_t i;
    measure::truth::Truth truth;
};

Table<BitsNeededPixel> make_bits_needed_pixel_table(int bits) {
    using R = BitsNeededPixel;
    return {{"x", "pixel", "column, from the left",
             [](const R& r) { return r.i % static_cast<std::size_t>(r.band->width); }},
            {"y", "pixel", "row, from the top",
             [](const R& r) {
                 return static_cast<std::size_t>(r.band->y0) + r.i / static_cast<std::size_t>(r.band->width);
             }},
            {"truth", "hit, miss or unresolved",
             [](const R& r) { return measure::truth::decision_names[static_cast<std::size_t>(r.truth.decision)]; }},
            {"truth_object", "primitive that the ray truly hits first, from 0",
             [](const R& r) { return when(r.truth.is_hit(), r.truth.primitive); }},
            {"needed", "bits",
             fmt::format("smallest width that suffices for {} correct bits, as does every wider one; inf if not even "
                         "53 bits suffice",
                         bits),
             table::or_missing([](const R& r) { return r.band->bits_needed[r.i]; })}};
}

using BitsNeededFormWriter = pixel::FormFilesWriter<BitsNeededBand, BitsNeededPixel>;

}  // namespace

struct BitsNeededWriter::Parts {
    const BitsNeededStudy& study;
    BitsNeededFilesOptions options;
    std::optional<table::TableFile<BitsNeededRow>> table = {};
    BitsNeededPictures pictures = make_pictures(study, options);
    std::vector<std::unique_ptr<BitsNeededFormWriter>> forms = {};

    void add_form(std::size_t form_index) {
        const Info& form = *study.tested_forms[form_index]->info;
        std::unique_ptr<table::TableFile<BitsNeededPixel>> pixels;
        if (options.writes_pixels_csv)
            pixels = std::make_unique<table::TableFile<BitsNeededPixel>>(
                options.keep_piece ? "" : options.folder, file_stem(form) + ".csv",
                fmt::format("One row per pixel: bits needed by {}", form.name),
                make_bits_needed_pixel_table(study.correct_bits));

        // The functions that turn a band into rows of the table and of the EXR.
        BitsNeededFormWriter::Functions functions{
            .add_pixel =
                [](table::TableFile<BitsNeededPixel>& file, const BitsNeededBand& band, std::size_t i) {
                    file.add({&band, i, band.truth(i)});
                },
            .pixels = [](const BitsNeededBand& band) { return band.bits_needed.size(); }};
        pixel::BandFiles<BitsNeededBand> files{pictures, {}, options.keep_piece};

        if (MapExr* const exr = options.exr) {
            functions.exr_scanlines = [exr](const BitsNeededBand& band, std::span<const image::Rgb8> preview) {
                return exr->make_rows(band, preview);
            };
            files.write_exr = [exr](const std::vector<ExrScanlines>& pieces) { exr->write(pieces); };
        }
        forms.push_back(
            std::make_unique<BitsNeededFormWriter>(form_index, files, std::move(functions), std::move(pixels)));
    }
};

BitsNeededWriter::BitsNeededWriter(const BitsNeededStudy& study, const BitsNeededFilesOptions& options)
    : parts_(new Parts{study, options}) {
    if (!options.keep_piece)
        parts_->table.emplace(
            options.folder, "needed.csv",
            fmt::format("One row per form: significand bits needed for {} correct bits", study.correct_bits),
            make_bits_needed_table());
    for (std::size_t form = 0; form < study.tested_forms.size(); ++form) parts_->add_form(form);
}

BitsNeededWriter::~BitsNeededWriter() = default;

measure::study::ShowBand<BitsNeededStudy> BitsNeededWriter::show() {
    return [this](std::size_t form, const BitsNeededBand& band) { parts_->forms.at(form)->add_band(band); };
}

std::vector<file::DataResource> BitsNeededWriter::resources() const {
    std::vector<file::DataResource> resources;
    if (parts_->table) resources.push_back(parts_->table->about());
    for (const auto& form : parts_->forms)
        if (form->table()) resources.push_back(form->table()->about());
    return resources;
}

void BitsNeededWriter::put(std::size_t form, pixel::Piece&& piece) { parts_->forms.at(form)->write_piece(piece); }

void BitsNeededWriter::finish(const std::vector<BitsNeededSummary>& summaries) {
    Parts& p = *parts_;
    p.pictures.writer().finish();
    for (std::size_t f = 0; f < p.forms.size(); ++f) {
        if (auto& pixels = p.forms[f]->table()) pixels->close();
        p.table->add({p.study.tested_forms[f]->info->name, p.study.correct_bits, &summaries[f], summaries[f].all()});
    }
    p.table->close();
}

}  // namespace lostbits::output::map
