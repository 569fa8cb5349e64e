// Writes columns of pixels to sheets and to pictures of their own.
#include "output/pixel/columns.hpp"

#include <algorithm>
#include <functional>

#include "intersect/process/parallel.hpp"

namespace lostbits::output::pixel {

using image::LegendEntry;

ColumnWriter::ColumnWriter(PictureFiles files, std::vector<ColumnSpec> columns)
    : width_(static_cast<std::size_t>(files.scene.width)),
      pixels_(files.scene.pixel_count()),
      has_single_pictures_(!files.single_picture_folder.empty()),
      columns_(std::move(columns)),
      captions_(columns_.size()) {
    for (const ColumnSpec& column : columns_) counts_.emplace_back(column.look->categories.size());
    if (!files.opens_files) return;

    for (auto& [file, spec] : files.sheets) {
        spec.field_width = files.scene.width;
        spec.field_height = files.scene.height;
        sheets_.push_back(std::make_unique<image::ContactSheet>(file, std::move(spec)));
    }

    for (const ColumnSpec& column : columns_) {
        if (!has_single_pictures_) break;
        files.stop.check();  // opening sixty pictures of a large scene takes twenty seconds
        open_single(files, column);
    }
}

void ColumnWriter::open_single(const PictureFiles& files, const ColumnSpec& column) {
    const scene::file::Scene& scene = files.scene;
    const auto path = files.single_picture_folder / column.file;
    SinglePicture& single = single_pictures_.emplace_back();
    if (column.has_only_pixels) {
        single.png = image::image_backend().open_png(path, scene.width, scene.height);
        return;
    }

    image::HeatmapSpec spec{.title = column.title,
                            .subtitle = {scene.title},
                            .width = scene.width,
                            .height = scene.height,
                            .scale = column.look->scale,
                            .bar_label = column.look->unit,
                            .legend = column.look->widest_legend(scene.pixel_count()),
                            .widest_caption = column.widest_caption};
    spec.subtitle.insert(spec.subtitle.end(), column.subtitle.begin(), column.subtitle.end());
    single.heatmap = std::make_unique<image::HeatmapWriter>(path, std::move(spec));
}

Strip ColumnWriter::empty_strip(std::size_t column, std::size_t pixels) const {
    return {std::vector<image::Rgb8>(pixels), CategoryCounts(counts_[column].size())};
}

void ColumnWriter::write_strip(std::size_t column, int y0, const Strip& strip) {
    for (std::size_t k = 0; k < counts_[column].size(); ++k) counts_[column][k] += strip.counts.at(k);
    for (const auto& [across, down, sheet] : columns_[column].sheet_positions)
        sheets_[sheet]->add_rows(across, down, y0, strip.colours);
    if (single_pictures_.empty()) return;
    const SinglePicture& single = single_pictures_[column];
    if (single.heatmap) single.heatmap->write_rows(strip.colours);
    else single.png->write_rows(static_cast<int>(strip.colours.size() / width_), strip.colours);
}

/// Lists each name once, in the order of the columns. If the look of a column makes a legend, that legend replaces the
/// list.
std::vector<LegendEntry> ColumnWriter::make_sheet_legend(std::size_t sheet) const {
    std::vector<LegendEntry> entries;  // each name once
    std::vector<bool> occurs;          // one per entry
    const Look* legend_look = nullptr;
    CategoryCounts legend_counts;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        if (std::ranges::count(columns_[c].sheet_positions, sheet, &SheetPosition::sheet) == 0) continue;

        // A look with a legend of its own gets the counts of all its columns.
        if (look(c).make_legend) {
            legend_look = &look(c);
            legend_counts.resize(counts_[c].size());
            std::ranges::transform(legend_counts, counts_[c], legend_counts.begin(), std::plus());
            continue;
        }

        const auto& categories = look(c).categories;
        for (std::size_t k = 0; k < categories.size(); ++k) {
            const auto& [name, colour, sheet_name] = categories[k];
            if (name.empty()) continue;
            const std::string& label = sheet_name.empty() ? name : sheet_name;
            const auto index =
                static_cast<std::size_t>(std::ranges::find(entries, label, &LegendEntry::label) - entries.begin());
            if (index == entries.size()) {
                entries.push_back({label, colour, ""});
                occurs.push_back(false);
            }
            if (counts_[c][k] > 0) occurs[index] = true;
        }
    }

    // Counts belong to one picture, so the legend of a sheet has none.
    std::vector<LegendEntry> legend =
        legend_look ? legend_look->legend(legend_counts, pixels_) : std::vector<LegendEntry>();
    for (LegendEntry& entry : legend) entry.count.clear();
    for (std::size_t k = 0; !legend_look && k < entries.size(); ++k)
        if (occurs[k]) legend.push_back(entries[k]);
    return legend;
}

void ColumnWriter::finish_single(std::size_t c) {
    if (single_pictures_[c].heatmap)
        single_pictures_[c].heatmap->finish(look(c).legend(counts_[c], pixels_), captions_[c]);
    else single_pictures_[c].png->close();
}

void ColumnWriter::finish(const std::vector<FinishedSheet>& ends) {
    // The pictures are finished in parallel: each has its own legend and its own file.
    intersect::process::in_parallel(std::size_t{0}, single_pictures_.size(),
                                    [this](std::size_t c) { finish_single(c); });

    for (std::size_t s = 0; s < sheets_.size(); ++s) {
        const FinishedSheet end = ends.empty() ? FinishedSheet{} : ends[s];
        auto legend = make_sheet_legend(s);
        if (!legend.empty()) legend.front().label += end.remark;
        sheets_[s]->finish(legend, end.order, end.headline);
    }
}

}  // namespace lostbits::output::pixel
