// Colour of a pixel of a column: its number on a colour scale, or the colour of its category.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "measure/answer/outcome.hpp"
#include "output/image/canvas.hpp"
#include "output/image/colour.hpp"

namespace lostbits::output::pixel {

[[nodiscard]] constexpr image::Rgb8 colour_of(measure::answer::Outcome o) {
    return image::outcome_colours[static_cast<std::size_t>(o)];
}

/// A kind of pixel, which a pixel has instead of a number or in addition to one.
struct Category {
    std::string name;  ///< name in legends; empty: no legend lists the category
    image::Rgb8 colour = {};
    std::string sheet_name = {};  ///< name in the legend of a sheet; empty: `name`
};

/// A pixel of a column. It is counted in its category. Its colour is that of `value` on the scale; without a value, it
/// is `colour`; without that, the colour of the category.
struct PixelValue {
    std::size_t category = 0;
    double value = std::numeric_limits<double>::quiet_NaN();
    std::optional<image::Rgb8> colour = {};
};

/// Number of pixels of each category.
using CategoryCounts = std::vector<std::uint64_t>;

/// Colours of the pixels of a column, and its legend.
struct Look {
    std::vector<Category> categories;
    std::optional<image::ColourScale> scale = {};
    std::string unit = {};  ///< unit above the colour bar
    /// Makes the legend, in place of the categories, from the counts and the number of pixels of the picture. Without
    /// counts (null) it makes the widest legend. Empty: the legend lists the categories.
    std::function<std::vector<image::LegendEntry>(const CategoryCounts*, std::uint64_t pixels)> make_legend = {};

    [[nodiscard]] image::Rgb8 colour(const PixelValue& pixel) const {
        if (!std::isnan(pixel.value)) return scale->colour_of_value(pixel.value);
        return pixel.colour ? *pixel.colour : categories[pixel.category].colour;
    }
    /// Legend of the categories that have a pixel, with their counts and their fractions of all pixels.
    [[nodiscard]] std::vector<image::LegendEntry> legend(const CategoryCounts& counts, std::uint64_t pixels) const;
    /// Legend of all categories, with the widest count that a picture of this number of pixels can have.
    [[nodiscard]] std::vector<image::LegendEntry> widest_legend(std::uint64_t pixels) const;
};

/// The viridis scale from `low` to `high`, logarithmic.
[[nodiscard]] image::ColourScale magnitude_scale(double low, double high);

/// A count and its fraction, for legends: `1234 (3.1%)`.
[[nodiscard]] std::string count_text(std::uint64_t count, std::uint64_t total);
/// The widest text that `count_text` returns for a picture of this number of pixels.
[[nodiscard]] std::string widest_count(std::uint64_t pixels);
/// A fraction in percent: `3.1%` or `<0.1%`; `-` if `total` is 0.
[[nodiscard]] std::string fraction_text(std::uint64_t count, std::uint64_t total);

}  // namespace lostbits::output::pixel
