#include "output/pixel/columns.hpp"

#include <algorithm>

namespace lostbits::output::pixel {

using image::LegendEntry;

ColumnWriter::ColumnWriter(Pages pages, std::vector<ColumnSpec> columns)
    : width_(static_cast<std::size_t>(pages.scene.width)), pixels_(pages.scene.pixels()), columns_(std::move(columns)) {
    for (const ColumnSpec& column : columns_) counts_.emplace_back(column.look->categories.size());
    pages.spec.field_width = pages.scene.width;
    pages.spec.field_height = pages.scene.height;
    pages.spec.legend = sheet_legend(true);
    for (LegendEntry& entry : pages.spec.legend)
        if (pages.counted) entry.count = widest_count(pages.scene.pixels());
    sheet_.emplace(image::image_backend(), pages.sheet, std::move(pages.spec));
    if (pages.singles.empty()) return;
    for (const ColumnSpec& column : columns_) {
        pages.stop.check();  // sixty pictures of a large scene take twenty seconds to open
        open_single(pages, column);
    }
}

void ColumnWriter::open_single(const Pages& pages, const ColumnSpec& column) {
    const scene::file::Scene& scene = pages.scene;
    image::ImageBackend& backend = image::image_backend();
    const auto path = pages.singles / column.file;
    Single& single = singles_.emplace_back();
    if (column.bare) {
        single.bare = backend.open_png(path, scene.width, scene.height);
        return;
    }
    image::HeatmapSpec spec{.title = column.title,
                            .subtitle = {scene.title},
                            .width = scene.width,
                            .height = scene.height,
                            .scale = column.look->scale,
                            .unit = column.look->unit,
                            .legend = column.look->widest_legend(scene.pixels())};
    spec.subtitle.insert(spec.subtitle.end(), column.subtitle.begin(), column.subtitle.end());
    single.heatmap = std::make_unique<image::HeatmapWriter>(backend, path, std::move(spec));
}

Strip ColumnWriter::strip(std::size_t column, std::size_t pixels) const {
    return {std::vector<image::Rgb8>(pixels), CategoryCounts(counts_[column].size())};
}

void ColumnWriter::put(std::size_t column, int y0, const Strip& strip) {
    for (std::size_t k = 0; k < strip.counts.size(); ++k) counts_[column][k] += strip.counts[k];
    for (const auto& [across, down] : columns_[column].places) sheet_->add_rows(across, down, y0, strip.colours);
    if (singles_.empty()) return;
    const Single& single = singles_[column];
    if (single.heatmap) single.heatmap->write_rows(strip.colours);
    else single.bare->write_rows(static_cast<int>(strip.colours.size() / width_), strip.colours);
}

/// A name once, in the order of the columns; where not `all`, those with a pixel.
std::vector<LegendEntry> ColumnWriter::sheet_legend(bool all) const {
    std::vector<LegendEntry> entries;
    std::vector<bool> occurs;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        if (columns_[c].places.empty()) continue;
        const auto& categories = look(c).categories;
        for (std::size_t k = 0; k < categories.size(); ++k) {
            const auto& [name, colour, on_sheet] = categories[k];
            if (name.empty()) continue;
            const std::string& label = on_sheet.empty() ? name : on_sheet;
            const auto at =
                static_cast<std::size_t>(std::ranges::find(entries, label, &LegendEntry::label) - entries.begin());
            if (at == entries.size()) {
                entries.push_back({label, colour, ""});
                occurs.push_back(all);
            }
            if (counts_[c][k] > 0) occurs[at] = true;
        }
    }
    std::vector<LegendEntry> shown;
    for (std::size_t k = 0; k < entries.size(); ++k)
        if (occurs[k]) shown.push_back(entries[k]);
    return shown;
}

void ColumnWriter::finish() {
    for (std::size_t c = 0; c < singles_.size(); ++c) {
        if (singles_[c].heatmap) singles_[c].heatmap->finish(look(c).legend(counts_[c], pixels_));
        else singles_[c].bare->close();
    }
    sheet_->finish(sheet_legend(false));
}

}  // namespace lostbits::output::pixel
