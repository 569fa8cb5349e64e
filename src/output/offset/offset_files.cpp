#include "output/offset/offset_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/file/datapackage.hpp"
#include "output/image/heatmap.hpp"
#include "output/map/row_names.hpp"
#include "output/offset/offset_colour.hpp"
#include "output/offset/offset_sheet.hpp"

namespace lostbits::output::offset {

using file::Cell;
using image::HeatmapWriter;
using measure::offset::both_sides;
using measure::offset::Fault;
using measure::offset::OffsetBand;
using measure::offset::OffsetRequest;
using measure::offset::OffsetRow;
using measure::offset::OffsetSummary;
using measure::offset::Side;
using measure::offset::Strategy;

namespace {

/// One picture of a row: the smallest safe offset to a side, or what becomes of a strategy there.
struct OffsetMap {
    Side side;
    std::size_t strategy;  ///< the number of strategies stands for the smallest safe offset
    std::unique_ptr<HeatmapWriter> heatmap;
    std::vector<std::uint64_t> counts;
};

std::vector<file::Column> pixel_columns(const OffsetRequest& request) {
    std::vector<file::Column> columns{{"x", "integer", "", "column of the pixel"},
                                      {"y", "integer", "", "row of the pixel"},
                                      {"object", "integer", "", "the solid that is left, from 0"}};
    for (const Side side : both_sides) {
        const std::string name(name_of(side));
        columns.push_back({"rays_" + name, "integer", "", "rays " + in_words(side)});
        columns.push_back({"safe_" + name, "number", "world units", "smallest safe offset; inf where none is"});
        columns.push_back({"quiet_" + name, "number", "world units",
                           "smallest offset that is safe by truth and by the form's arithmetic; inf where none is"});
        for (const Strategy* s : request.strategies) {
            columns.push_back({short_name(*s) + "_self_hits_" + name, "integer", "",
                               "rays of " + std::string(s->name) + " that meet by truth what they leave"});
            columns.push_back({short_name(*s) + "_bad_" + name, "integer", "",
                               "rays of " + std::string(s->name) +
                                   " with any fault but a start on the wrong side, which alone harms nothing"});
        }
    }
    return columns;
}

}  // namespace

std::string row_name(const OffsetRow& row) { return fmt::format("{}.{}", map::row_name(row.row), name_of(row.point)); }

std::string subject(const OffsetRow& row) {
    return fmt::format("{} in {}, {} points", row.row.form->info->name, row.row.format.name, name_of(row.point));
}

std::string in_words(Side side) { return side == Side::outside ? "away from the solid" : "into the solid"; }

std::vector<file::Column> offset_summary_columns() {
    std::vector<file::Column> columns{
        {"strategy", "string", "", "how the new origin is made: a row of the table of strategies"},
        {"side", "string", "", "where the new rays go: outside (light, mirror, hemisphere) or inside (refraction)"},
        {"point", "string", "", "what is left: the point as computed, or put back onto the surface (projected)"},
        {"form", "string", "", "form that finds the points, and that is asked for self-hits"},
        {"format", "string", "", "format that everything is computed in"},
        {"operations", "integer", "", "operations that one new ray costs, as the strategy is written"}};
    for (const measure::offset::OffsetColumn& c : measure::offset::offset_columns())
        columns.push_back(
            {std::string(c.name), c.whole ? "integer" : "number", std::string(c.unit), std::string(c.meaning)});
    return columns;
}

void add_summary_rows(const OffsetRequest& request, const std::vector<OffsetSummary>& summaries, file::CsvWriter& table,
                      const std::vector<Cell>& before) {
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        const OffsetRow& row = request.rows[r];
        for (const Side side : both_sides) {
            for (std::size_t k = 0; k < request.strategies.size(); ++k) {
                for (const Cell& cell : before) table.add(cell);
                table.add(request.strategies[k]->name)
                    .add(name_of(side))
                    .add(name_of(row.point))
                    .add(row.row.form->info->name)
                    .add(row.row.format.name)
                    .add(request.strategies[k]->operations(row.row.form->shape));
                for (const measure::offset::OffsetColumn& c : measure::offset::offset_columns()) {
                    const double x = c.value(summaries[r], side, k);
                    table.add(std::isnan(x) ? Cell() : c.whole ? Cell(static_cast<std::uint64_t>(x)) : Cell(x));
                }
                table.end_row();
            }
        }
    }
}

/// The files of one form in one format, for one way to take its points.
class OffsetRowFiles {
public:
    OffsetRowFiles(const OffsetRequest& request, const OffsetRow& row, const OffsetFilesOptions& options)
        : request_(request), row_(row), scale_(safe_scale(image::image_backend())) {
        for (const Side side : both_sides) {
            for (std::size_t k = 0; k <= request.strategies.size(); ++k) {
                request.limit.stop.check();  // sixty pictures of a large scene take twenty seconds to open
                open(side, k, options.folder);
            }
        }
        if (options.pixels_csv) pixels_.emplace(options.folder / (row_name(row) + ".csv"), pixel_columns(request));
    }

    void band(const OffsetBand& band) {
        std::vector<image::Rgb8> field(band.is_point.size());
        for (OffsetMap& map : maps_) {
            const bool safe = is_safe_map(map);
            for (std::size_t i = 0; i < field.size(); ++i) {
                const auto shown = safe ? Shown::safe : shown_of(band, i, map.side, map.strategy);
                field[i] = safe ? safe_colour(scale_, band, i, map.side) : colour_of(shown);
                ++map.counts[static_cast<std::size_t>(safe ? static_cast<int>(needed_of(band, i, map.side))
                                                           : static_cast<int>(shown))];
            }
            map.heatmap->write_rows(field);
        }
        if (pixels_) add_pixels(band);
    }

    void finish() {
        const std::uint64_t pixels = request_.scene->pixels();
        for (OffsetMap& map : maps_)
            map.heatmap->finish(is_safe_map(map) ? needed_legend(map.counts, pixels)
                                                 : shown_legend(map.counts, pixels));
        if (pixels_) pixels_->close();
    }

private:
    [[nodiscard]] bool is_safe_map(const OffsetMap& map) const { return map.strategy == request_.strategies.size(); }

    void open(Side side, std::size_t k, const std::filesystem::path& folder) {
        const bool safe = k == request_.strategies.size();
        const std::uint64_t pixels = request_.scene->pixels();
        image::HeatmapSpec spec{
            .title = safe ? fmt::format("The smallest safe offset {}", in_words(side))
                          : fmt::format("{} {}", request_.strategies[k]->name, in_words(side)),
            .subtitle = {request_.scene->title, subject(row_),
                         safe ? "colour: the smallest offset along the normal from which every ray is right by truth, "
                                "clamped at both ends of the bar"
                              : fmt::format("the new origin: {}", request_.strategies[k]->title)},
            .width = request_.scene->width,
            .height = request_.scene->height,
            .scale = safe ? std::optional(scale_) : std::nullopt,
            .unit = safe ? safe_unit : "",
            .legend = safe ? widest_needed_legend(pixels) : widest_shown_legend(pixels)};
        const std::string name = fmt::format("{}.{}.{}.png", row_name(row_), name_of(side),
                                             safe ? "safe" : short_name(*request_.strategies[k]));
        maps_.push_back({side, k,
                         std::make_unique<HeatmapWriter>(image::image_backend(), folder / name, std::move(spec)),
                         std::vector<std::uint64_t>(shown_labels.size())});
    }

    void add_pixels(const OffsetBand& band) {
        for (std::size_t i = 0; i < band.is_point.size(); ++i) {
            if (band.is_point[i] == 0) continue;
            pixels_->add(static_cast<int>(i) % band.width).add(band.y0 + static_cast<int>(i) / band.width);
            pixels_->add(band.object[i]);
            for (const Side side : both_sides) {
                const measure::offset::SideOfPoint& at = band.sides[i][static_cast<std::size_t>(side)];
                pixels_->add(at.rays).add(at.safe).add(at.quiet);
                for (std::size_t k = 0; k < band.strategies; ++k)
                    pixels_->add(band.at(i, side, k)[Fault::self_hit]).add(band.at(i, side, k).bad);
            }
            pixels_->end_row();
        }
    }

    const OffsetRequest& request_;
    const OffsetRow& row_;
    image::ColourScale scale_;
    std::vector<OffsetMap> maps_;
    std::optional<file::CsvWriter> pixels_;
};

struct OffsetFiles::Parts {
    Parts(const OffsetRequest& of, const OffsetFilesOptions& with)
        : request(of),
          options(with),
          table(with.folder / "summary.csv", offset_summary_columns()),
          sheet(image::image_backend(), with.folder / "contact.png", of) {
        for (const OffsetRow& row : of.rows) rows.push_back(std::make_unique<OffsetRowFiles>(of, row, with));
    }

    const OffsetRequest& request;
    OffsetFilesOptions options;
    file::CsvWriter table;
    OffsetSheet sheet;
    std::vector<std::unique_ptr<OffsetRowFiles>> rows;
};

OffsetFiles::OffsetFiles(const OffsetRequest& request, const OffsetFilesOptions& options)
    : parts_(new Parts(request, options)) {}

OffsetFiles::~OffsetFiles() = default;

void OffsetFiles::band(std::size_t row, const OffsetBand& band) {
    parts_->rows[row]->band(band);
    parts_->sheet.band(row, band);
}

void OffsetFiles::finish(const std::vector<OffsetSummary>& summaries) {
    Parts& p = *parts_;
    for (auto& row : p.rows) row->finish();
    p.sheet.finish(summaries);
    std::vector<file::DataResource> resources{
        {"summary.csv", "One row per strategy, side, kind of point, form and format", offset_summary_columns()}};
    if (p.options.pixels_csv) {
        for (const OffsetRow& row : p.request.rows)
            resources.push_back(
                {row_name(row) + ".csv", "One row per pixel with a point that counts", pixel_columns(p.request)});
    }
    resources.insert(resources.end(), p.options.also.begin(), p.options.also.end());
    add_summary_rows(p.request, summaries, p.table);
    file::write_datapackage(p.options.folder / "datapackage.json", p.request.scene->title, resources);
    p.table.close();  // last: a folder with a summary is a finished one
}

}  // namespace lostbits::output::offset
