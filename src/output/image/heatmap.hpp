// A field as a picture with title, colour bar and legend.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "output/image/canvas.hpp"
#include "output/image/colour.hpp"
#include "output/image/figure.hpp"

namespace lostbits::output::image {

/// Description of a heatmap, known before the first pixel.
struct HeatmapSpec {
    std::string title;
    std::vector<std::string> subtitle;
    int width = 0, height = 0;         ///< size of the field, in samples
    std::optional<ColourScale> scale;  ///< missing if the map has only categories
    std::string bar_label;             ///< label over the colour bar: `lost bits`
    std::vector<LegendEntry> legend;   ///< every class that may occur, with the widest count that it may get
    /// Space for the lines above the legend, whose text is known only at the end; empty: no space.
    std::string widest_caption = {};
};

/// Streams a field into a picture. Fields narrower than 384 samples are enlarged by a whole factor with nearest
/// neighbour, so that one sample is one visible square. Memory does not grow with the height, unless the run writes an
/// SVG or a PDF. One writer serves one thread at a time.
class HeatmapWriter {
public:
    /// Opens `path` and writes the heading. Throws EnvironmentError, and std::logic_error for a field without samples.
    HeatmapWriter(const std::filesystem::path& path, HeatmapSpec spec);

    /// Writes the next whole rows of the field, from top to bottom. Throws EnvironmentError (a full disk), and
    /// std::logic_error for an incomplete row or for too many rows.
    void write_rows(std::span<const Rgb8> samples);

    /// Writes the caption if the spec has space for one; a last line that is too long gets smaller letters or is
    /// shortened. Then writes the legend and gives the file its final name. `legend` holds the classes of the spec that
    /// occurred, with their counts. Throws as write_rows does, and std::logic_error if rows are missing.
    void finish(std::span<const LegendEntry> legend, std::string_view caption = {});

private:
    void write_body_row(std::span<const Rgb8> samples);
    void save_other_files(const Canvas& foot);

    HeatmapSpec spec_;
    [[nodiscard]] int foot_height() const;
    [[nodiscard]] int caption_height() const;
    int enlargement_ = 1;
    int field_width_ = 0, field_height_ = 0, body_height_ = 0, canvas_width_ = 0;
    int caption_lines_ = 0;
    int written_rows_ = 0;  ///< rows of the field that were passed to `write_rows`
    int body_y_ = 0;        ///< rows of the body that were written
    Canvas head_{0, 0}, bar_{0, 0};
    std::optional<Legend> legend_;
    std::vector<Rgb8> canvas_row_, bar_pixels_;
    std::unique_ptr<PngWriter> png_;                     ///< null if the run writes no PNG
    std::unique_ptr<FigureWriter> other_figure_writer_;  ///< files of the other kinds, written at the end
    std::vector<Rgb8> field_;                            ///< the whole field, for the other kinds
};

}  // namespace lostbits::output::image
