// One field as a picture that explains itself: title, colour bar, legend.
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
#include "output/image/image.hpp"

namespace lostbits::output::image {

/// What a heatmap shows; all of it is known before the first pixel.
struct HeatmapSpec {
    std::string title;
    std::vector<std::string> subtitle;
    int width = 0, height = 0;         ///< of the field, in samples
    std::optional<ColourScale> scale;  ///< none for a map of classes or objects alone
    std::string unit;                  ///< over the colour bar: `lost bits`
    std::vector<LegendEntry> legend;   ///< every class that may occur, each with the widest count it may get
    std::string widest_caption = {};   ///< room for lines above the legend that are known at the end; empty: none
};

/// Streams a field into a PNG. Fields narrower than 384 samples are enlarged by a whole factor, nearest neighbour, so
/// that one sample stays one visible square. Memory does not grow with the height. One thread at a time.
class HeatmapWriter {
public:
    /// Opens `path` and writes the heading. Throws EnvironmentError, and std::logic_error for a field without samples.
    HeatmapWriter(const std::filesystem::path& path, HeatmapSpec spec);

    /// The next rows of the field, whole rows from top to bottom. Throws EnvironmentError (a full disk), and
    /// std::logic_error for a part of a row or a row too many.
    void write_rows(std::span<const Rgb8> samples);

    /// Writes the caption where the spec has room for one, in its lines, the last one small or shortened where it is
    /// longer than that; then the legend, and gives the file its final name. `legend` holds
    /// those classes of the spec that occurred, with their counts. Throws as write_rows does, and std::logic_error when
    /// rows are lacking.
    void finish(std::span<const LegendEntry> legend, std::string_view caption = {});

private:
    void put_body_row(std::span<const Rgb8> samples);

    HeatmapSpec spec_;
    [[nodiscard]] int foot_height() const;
    [[nodiscard]] int caption_height() const;
    int factor_ = 1;
    int field_width_ = 0, field_height_ = 0, body_height_ = 0, page_width_ = 0;
    int caption_lines_ = 0;
    int rows_ = 0;    // of the field, taken
    int body_y_ = 0;  // of the body, written
    Canvas bar_{0, 0};
    std::optional<Legend> legend_;
    std::vector<Rgb8> line_;
    std::unique_ptr<PngWriter> png_;
};

}  // namespace lostbits::output::image
