// What a pixel looks like in a rendered picture and in its difference maps.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "measure/picture/render.hpp"
#include "output/image/canvas.hpp"
#include "output/image/colour.hpp"
#include "output/image/image.hpp"

namespace lostbits::output {

/// In a picture: a channel at NaN, and a colour that is not proved. Neither is a colour of the picture.
inline constexpr Rgb8 nan_colour{255, 0, 255};
inline constexpr Rgb8 unproved_colour = outcome_colours[static_cast<std::size_t>(Outcome::unresolved)];

[[nodiscard]] Rgb8 picture_colour(const Painted& pixel);
[[nodiscard]] Rgb8 picture_colour(const TrueColour& colour);

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
[[nodiscard]] ColourScale error_map_scale(ErrorMap d, ImageBackend& backend);

/// On pixels that both see alike the value on the ramp (an unchanged background stays grey), else the class.
[[nodiscard]] Rgb8 error_map_colour(const ColourScale& scale, Seen seen, double value);
[[nodiscard]] Rgb8 shadow_colour(Seen seen, Shadow shadow);

/// Classes of pixels with their counts; those without a pixel are left out. `widest_` lists all that may come.
[[nodiscard]] std::vector<LegendEntry> seen_legend(const RenderSummary& s);
[[nodiscard]] std::vector<LegendEntry> widest_seen_legend(std::uint64_t pixels);
[[nodiscard]] std::vector<LegendEntry> shadow_legend(const RenderSummary& s);
[[nodiscard]] std::vector<LegendEntry> widest_shadow_legend(std::uint64_t pixels);

}  // namespace lostbits::output
