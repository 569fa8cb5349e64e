// How a pixel of a column looks: its number on a scale, or its category's colour.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measure/answer/outcome.hpp"
#include "output/image/canvas.hpp"
#include "output/image/colour.hpp"

namespace lostbits::output::pixel {

[[nodiscard]] constexpr image::Rgb8 colour_of(measure::answer::Outcome o) {
    return image::outcome_colours[static_cast<std::size_t>(o)];
}

/// What a pixel may be in place of a number, or beside it.
struct Category {
    std::string name;  ///< as legends have it; empty: no legend lists it
    image::Rgb8 colour = {};
    std::string on_sheet = {};  ///< its name where several columns share a legend; empty: the same
};

/// A pixel of a column: it is counted as its category; its number is drawn, or else the colour that it brings itself,
/// or else the category's.
struct PixelValue {
    std::size_t category = 0;
    double value = std::numeric_limits<double>::quiet_NaN();
    std::optional<image::Rgb8> colour = {};
};

/// Pixels of each category.
using CategoryCounts = std::vector<std::uint64_t>;

struct Look {
    std::vector<Category> categories;
    std::optional<image::ColourScale> scale = {};
    std::string unit = {};  ///< over the bar of the scale
    /// Makes the legend of counts in place of the categories, of no counts the widest one, in a picture of so many
    /// pixels; none: see `legend`.
    std::function<std::vector<image::LegendEntry>(const CategoryCounts*, std::uint64_t pixels)> own_legend = {};

    [[nodiscard]] image::Rgb8 colour(const PixelValue& pixel) const {
        if (!std::isnan(pixel.value)) return scale->map(pixel.value);
        return pixel.colour ? *pixel.colour : categories[pixel.category].colour;
    }
    /// The categories that have a pixel, with their counts and shares of all pixels.
    [[nodiscard]] std::vector<image::LegendEntry> legend(const CategoryCounts& counts, std::uint64_t pixels) const;
    /// All of them with the widest count in a picture of so many pixels.
    [[nodiscard]] std::vector<image::LegendEntry> widest_legend(std::uint64_t pixels) const;
};

/// Viridis between these, by powers of two.
[[nodiscard]] image::ColourScale magnitude_scale(double low, double high);

/// `1234 (3.1%)`: a count and its share, as legends have it.
[[nodiscard]] std::string count_text(std::uint64_t count, std::uint64_t total);
/// As wide as `count_text` of so many pixels gets.
[[nodiscard]] std::string widest_count(std::uint64_t pixels);
/// `3.1%`, `<0.1%`; `-` of nothing.
[[nodiscard]] std::string share_text(std::uint64_t part, std::uint64_t whole);

}  // namespace lostbits::output::pixel
