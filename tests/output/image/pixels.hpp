// Searches in pictures: rectangles of one colour, single pixels.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "output/image/canvas.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::test {

inline output::image::Rgb8 pixel_at(const output::image::PngImage& image, int x, int y) {
    return image.pixels[y * image.width + x];
}

inline output::image::Rgb8 pixel_at(const output::image::Canvas& canvas, int x, int y) {
    return canvas.pixels()[y * canvas.width() + x];
}

inline std::int64_t count_of(const output::image::PngImage& image, output::image::Rgb8 colour) {
    return std::ranges::count(image.pixels, colour);
}

/// The top left corner of the first rectangle of that size and colour, line by line.
inline std::optional<std::pair<int, int>> find_block(const output::image::PngImage& image, output::image::Rgb8 colour,
                                                     int width, int height) {
    const auto all = [&](int x0, int y0) {
        for (int y = y0; y < y0 + height; ++y) {
            for (int x = x0; x < x0 + width; ++x) {
                if (pixel_at(image, x, y) != colour) return false;
            }
        }
        return true;
    };
    for (int y = 0; y + height <= image.height; ++y) {
        for (int x = 0; x + width <= image.width; ++x) {
            if (all(x, y)) return std::pair{x, y};
        }
    }
    return std::nullopt;
}

inline bool rim_is_blank(const output::image::PngImage& image) {
    const int rim = image::style::margin - 1;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const bool inside = x >= rim && y >= rim && x < image.width - rim && y < image.height - rim;
            if (!inside && pixel_at(image, x, y) != image::style::background) return false;
        }
    }
    return true;
}

}  // namespace lostbits::output::test
