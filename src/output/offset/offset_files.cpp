#include "output/offset/offset_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/image/heatmap.hpp"
#include "output/map/row_names.hpp"
#include "output/offset/offset_colour.hpp"
#include "output/offset/offset_sheet.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::offset {

using image::HeatmapWriter;
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

/// One picture of a row: the smallest safe offset to a side, or what becomes of a strategy there.
struct OffsetMap {
    Side side;
    std::size_t strategy;  ///< the number of strategies stands for the smallest safe offset
    std::unique_ptr<HeatmapWriter> heatmap;
    std::vector<std::uint64_t> counts;
};

struct OffsetPixel {
    const OffsetBand* band;
    std::size_t i;
};

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

std::string row_name(const OffsetRow& row) { return fmt::format("{}.{}", map::row_name(row.row), name_of(row.point)); }

std::string subject(const OffsetRow& row) {
    return fmt::format("{} in {}, {} points", row.row.form->info->name, row.row.format.name, name_of(row.point));
}

std::string in_words(Side side) { return side == Side::outside ? "away from the solid" : "into the solid"; }

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
        if (options.pixels_csv)
            pixels_.emplace(options.folder, row_name(row) + ".csv", "One row per pixel with a point that counts",
                            pixel_table(request));
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
        for (std::size_t i = 0; pixels_ && i < band.is_point.size(); ++i)
            if (band.is_point[i] != 0) pixels_->add({&band, i});
    }

    void finish() {
        const std::uint64_t pixels = request_.scene->pixels();
        for (OffsetMap& map : maps_)
            map.heatmap->finish(is_safe_map(map) ? needed_legend(map.counts, pixels)
                                                 : shown_legend(map.counts, pixels));
        if (pixels_) pixels_->close();
    }

    /// Of its pixels, where there is one.
    [[nodiscard]] const std::optional<table::TableFile<OffsetPixel>>& table() const { return pixels_; }

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

    const OffsetRequest& request_;
    const OffsetRow& row_;
    image::ColourScale scale_;
    std::vector<OffsetMap> maps_;
    std::optional<table::TableFile<OffsetPixel>> pixels_;
};

struct OffsetFiles::Parts {
    Parts(const OffsetRequest& of, const OffsetFilesOptions& with)
        : request(of),
          options(with),
          table(with.folder, "summary.csv", "One row per strategy, side, kind of point, form and format",
                strategy_table()),
          sheet(image::image_backend(), with.folder / "contact.png", of) {
        for (const OffsetRow& row : of.rows) rows.push_back(std::make_unique<OffsetRowFiles>(of, row, with));
    }

    const OffsetRequest& request;
    OffsetFilesOptions options;
    table::TableFile<StrategyRow> table;
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
    std::vector<file::DataResource> resources{p.table.about()};
    for (const auto& row : p.rows)
        if (row->table()) resources.push_back(row->table()->about());
    resources.insert(resources.end(), p.options.also.begin(), p.options.also.end());
    p.table.add_all(strategy_rows(p.request, summaries));
    file::write_datapackage(p.options.folder / "datapackage.json", p.request.scene->title, resources);
    p.table.close();  // last: a folder with a summary is a finished one
}

}  // namespace lostbits::output::offset
