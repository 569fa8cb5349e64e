// What a pixel looks like in the pictures of questions put in two ways.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "measure/consistency/consistency.hpp"
#include "output/image/colour.hpp"
#include "output/image/heatmap.hpp"

namespace lostbits::output::consistency {

/// Pixels of each `Accord`.
using AccordCounts = std::array<std::uint64_t, measure::consistency::accord_names.size()>;

/// How many ulps further apart than the exact ones both ends of a chord are, 2^-2 to 2^14, clamped.
[[nodiscard]] image::ColourScale excess_scale(image::ImageBackend& backend);
inline constexpr const char* excess_unit = "ulps of the length";

/// The fixed colour of how two answers stand; where numbers are compared and both rays hit, the ramp's.
[[nodiscard]] image::Rgb8 colour_at(const image::ColourScale& scale, const measure::consistency::AccordOfPixels& pixels,
                                    std::size_t i);
/// Whether the pixel has a fixed colour: these are what a legend counts.
[[nodiscard]] bool is_category(const measure::consistency::AccordOfPixels& pixels, std::size_t i);

/// What `check` makes of each class, with its count; those without a pixel are left out.
[[nodiscard]] std::vector<image::LegendEntry> accord_legend(const measure::consistency::Check& check,
                                                            const AccordCounts& counts, std::uint64_t pixels);
/// Every class with the widest count.
[[nodiscard]] std::vector<image::LegendEntry> widest_accord_legend(const measure::consistency::Check& check,
                                                                   std::uint64_t pixels);
/// In words that hold for every check, and without counts: of a sheet of several.
[[nodiscard]] std::vector<image::LegendEntry> sheet_legend(const AccordCounts& counts);

}  // namespace lostbits::output::consistency
