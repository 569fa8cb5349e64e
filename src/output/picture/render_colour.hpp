// What a pixel looks like in a rendered picture and in its difference maps.
#pragma once

#include <array>
#include <vector>

#include "measure/picture/render.hpp"
#include "output/image/canvas.hpp"
#include "output/image/colour.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::picture {

/// In a picture: a channel at NaN, and a colour that is not proved. Neither is a colour of the picture.
inline constexpr image::Rgb8 nan_colour{255, 0, 255};
inline constexpr image::Rgb8 unproved_colour =
    image::outcome_colours[static_cast<std::size_t>(measure::answer::Outcome::unresolved)];

[[nodiscard]] image::Rgb8 picture_colour(const measure::picture::Painted& pixel);
[[nodiscard]] image::Rgb8 picture_colour(const measure::picture::TrueColour& colour);

/// The difference maps that are numbers.
enum class ErrorMap : std::uint8_t { colour, normal, residual };
inline constexpr std::array<const char*, 3> error_map_names{"colour", "normal", "residual"};

struct ErrorMapKind {
    const char* title;
    const char* unit;
    const char* note;
    double low, high;  ///< ends of the colour bar, logarithmic
};
[[nodiscard]] const ErrorMapKind& error_map_kind(ErrorMap d);
[[nodiscard]] image::ColourScale error_map_scale(ErrorMap d, image::ImageBackend& backend);

/// On pixels that both see alike the value on the ramp (an unchanged background stays grey), else the class.
[[nodiscard]] image::Rgb8 error_map_colour(const image::ColourScale& scale, measure::picture::Seen seen, double value);
[[nodiscard]] image::Rgb8 shadow_colour(measure::picture::Seen seen, measure::picture::Shadow shadow);

/// Classes of pixels with their counts; those without a pixel are left out. `widest_` lists all that may come.
[[nodiscard]] std::vector<image::LegendEntry> seen_legend(const measure::picture::RenderSummary& s);
[[nodiscard]] std::vector<image::LegendEntry> widest_seen_legend(std::uint64_t pixels);
[[nodiscard]] std::vector<image::LegendEntry> shadow_legend(const measure::picture::RenderSummary& s);
[[nodiscard]] std::vector<image::LegendEntry> widest_shadow_legend(std::uint64_t pixels);

}  // namespace lostbits::output::picture
