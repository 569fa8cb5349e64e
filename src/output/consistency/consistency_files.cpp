#include "output/consistency/consistency_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "output/blame/explain_command.hpp"
#include "output/consistency/accord_colour.hpp"
#include "output/consistency/consistency_sheet.hpp"
#include "output/file/datapackage.hpp"
#include "output/image/heatmap.hpp"
#include "output/map/row_names.hpp"

namespace lostbits::output::consistency {

using file::Cell;
using image::HeatmapWriter;
using measure::consistency::accord_names;
using measure::consistency::AccordOfPixels;
using measure::consistency::Check;
using measure::consistency::CheckSummary;
using measure::consistency::ConsistencyBand;
using measure::consistency::ConsistencyRequest;
using measure::consistency::RowChecks;
using measure::map::MapRow;

namespace {

/// One picture: what a check finds of a row.
struct CheckMap {
    std::unique_ptr<HeatmapWriter> heatmap;
    AccordCounts counts{};
};

std::vector<file::Column> pixel_columns(const ConsistencyRequest& request) {
    std::string known;
    for (const std::string_view name : accord_names) known += fmt::format("{}{}", known.empty() ? "" : ", ", name);
    std::vector<file::Column> columns{{"x", "integer", "", "column of the pixel"},
                                      {"y", "integer", "", "row of the pixel"}};
    for (const Check* check : request.checks) {
        columns.push_back({std::string(check->name), "string", "", fmt::format("{}: {}", check->title, known)});
        if (!check->numbers) continue;
        columns.push_back({fmt::format("{}_apart", check->name), "number", "ulp",
                           "|near + far from the other end - length| in ulps of the length"});
        columns.push_back(
            {fmt::format("{}_excess", check->name), "number", "ulp", "how far that is from the exact sum"});
    }
    return columns;
}

/// The files of one form in one format.
class ConsistencyRowFiles {
public:
    ConsistencyRowFiles(const ConsistencyRequest& request, const MapRow& row, const ConsistencyFilesOptions& options)
        : request_(request), scale_(excess_scale(image::image_backend())) {
        for (const Check* check : request.checks) {
            request.limit.stop.check();
            open(*check, row, options.folder);
        }
        if (options.pixels_csv) pixels_.emplace(options.folder / (map::row_name(row) + ".csv"), pixel_columns(request));
    }

    void band(const ConsistencyBand& band) {
        for (std::size_t c = 0; c < maps_.size(); ++c) {
            const AccordOfPixels& pixels = band.checks[c];
            std::vector<image::Rgb8> field(pixels.accord.size());
            for (std::size_t i = 0; i < field.size(); ++i) {
                field[i] = colour_at(scale_, pixels, i);
                if (is_category(pixels, i)) ++maps_[c].counts[static_cast<std::size_t>(pixels.accord[i])];
            }
            maps_[c].heatmap->write_rows(field);
        }
        if (pixels_) add_pixels(band);
    }

    void finish() {
        for (std::size_t c = 0; c < maps_.size(); ++c)
            maps_[c].heatmap->finish(accord_legend(*request_.checks[c], maps_[c].counts, request_.scene->pixels()));
        if (pixels_) pixels_->close();
    }

private:
    void open(const Check& check, const MapRow& row, const std::filesystem::path& folder) {
        image::HeatmapSpec spec{
            .title = fmt::format("{}: {}", check.name, check.title),
            .subtitle = {request_.scene->title, fmt::format("{} in {}", row.form->info->name, row.format.name),
                         check.numbers ? "colour: by how much more than the exact answers the chord differs from "
                                         "either end, clamped at both ends of the bar"
                                       : ""},
            .width = request_.scene->width,
            .height = request_.scene->height,
            .scale = check.numbers ? std::optional(scale_) : std::nullopt,
            .unit = check.numbers ? excess_unit : "",
            .legend = widest_accord_legend(check, request_.scene->pixels())};
        if (!check.numbers) spec.subtitle.pop_back();
        const std::string name = fmt::format("{}.{}.png", map::row_name(row), check.name);
        maps_.push_back({std::make_unique<HeatmapWriter>(image::image_backend(), folder / name, std::move(spec)), {}});
    }

    void add_pixels(const ConsistencyBand& band) {
        for (std::size_t i = 0; i < band.checks.front().accord.size(); ++i) {
            pixels_->add(static_cast<int>(i) % band.width).add(band.y0 + static_cast<int>(i) / band.width);
            for (std::size_t c = 0; c < band.checks.size(); ++c) {
                const AccordOfPixels& pixels = band.checks[c];
                pixels_->add(accord_names[static_cast<std::size_t>(pixels.accord[i])]);
                if (!request_.checks[c]->numbers) continue;
                const bool any = !pixels.excess.empty();
                pixels_->add(any ? file::number_or_missing(pixels.apart[i]) : Cell());
                pixels_->add(any ? file::number_or_missing(pixels.excess[i]) : Cell());
            }
            pixels_->end_row();
        }
    }

    const ConsistencyRequest& request_;
    image::ColourScale scale_;
    std::vector<CheckMap> maps_;
    std::optional<file::CsvWriter> pixels_;
};

void add_first(const MapRow& row, const CheckSummary& summary, file::CsvWriter& table) {
    if (!summary.shown) {
        for (int k = 0; k < 4; ++k) table.add(Cell());
        return;
    }
    table.add(summary.shown->x).add(summary.shown->y);
    for (const auto* group : {&summary.shown->rays.first, &summary.shown->rays.second})
        table.add(group->solids.empty() ? Cell() : Cell(blame::explain_command(blame::name_of_ray(group), row)));
}

void add_rows(const ConsistencyRequest& request, const std::vector<RowChecks>& rows, file::CsvWriter& table) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t c = 0; c < rows[r].size(); ++c) {
            table.add(request.checks[c]->name).add(request.rows[r].form->info->name).add(request.rows[r].format.name);
            for (const auto& column : measure::consistency::consistency_columns()) {
                const double x = column.value(rows[r][c]);
                table.add(std::isnan(x) ? Cell() : column.whole ? Cell(static_cast<std::uint64_t>(x)) : Cell(x));
            }
            add_first(request.rows[r], rows[r][c], table);
            table.end_row();
        }
    }
}

}  // namespace

std::vector<file::Column> consistency_summary_columns() {
    std::vector<file::Column> columns{{"check", "string", "", "which questions are compared: a row of the checks"},
                                      {"form", "string", "", "form that is asked"},
                                      {"format", "string", "", "format that everything is computed in"}};
    for (const auto& c : measure::consistency::consistency_columns())
        columns.push_back(
            {std::string(c.name), c.whole ? "integer" : "number", std::string(c.unit), std::string(c.meaning)});
    columns.push_back({"first_x", "integer", "", "column of the first pixel that the form is to blame for"});
    columns.push_back({"first_y", "integer", "", "its row"});
    columns.push_back({"first_explain", "string", "", "command that explains the ray of the first question there"});
    columns.push_back({"second_explain", "string", "", "command that explains the ray of the second"});
    return columns;
}

struct ConsistencyFiles::Parts {
    Parts(const ConsistencyRequest& of, const ConsistencyFilesOptions& with)
        : request(of),
          options(with),
          table(with.folder / "summary.csv", consistency_summary_columns()),
          sheet(image::image_backend(), with.folder / "contact.png", of) {
        for (const MapRow& row : of.rows) rows.push_back(std::make_unique<ConsistencyRowFiles>(of, row, with));
    }

    const ConsistencyRequest& request;
    ConsistencyFilesOptions options;
    file::CsvWriter table;
    ConsistencySheet sheet;
    std::vector<std::unique_ptr<ConsistencyRowFiles>> rows;
};

ConsistencyFiles::ConsistencyFiles(const ConsistencyRequest& request, const ConsistencyFilesOptions& options)
    : parts_(new Parts(request, options)) {}

ConsistencyFiles::~ConsistencyFiles() = default;

void ConsistencyFiles::band(std::size_t row, const ConsistencyBand& band) {
    parts_->rows[row]->band(band);
    parts_->sheet.band(row, band);
}

void ConsistencyFiles::finish(const std::vector<RowChecks>& rows) {
    Parts& p = *parts_;
    for (auto& row : p.rows) row->finish();
    p.sheet.finish(rows);
    std::vector<file::DataResource> resources{
        {"summary.csv", "One row per check, form and format", consistency_summary_columns()}};
    if (p.options.pixels_csv) {
        for (const MapRow& row : p.request.rows)
            resources.push_back({map::row_name(row) + ".csv", "One row per pixel", pixel_columns(p.request)});
    }
    add_rows(p.request, rows, p.table);
    file::write_datapackage(p.options.folder / "datapackage.json", p.request.scene->title, resources);
    p.table.close();  // last: a folder with a summary is a finished one
}

}  // namespace lostbits::output::consistency
