// What a point looks like in the pictures of offsets.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "measure/offset/offsets.hpp"
#include "output/image/colour.hpp"
#include "output/image/heatmap.hpp"

namespace lostbits::output::offset {

/// What became of the rays of a strategy at a point; of several, the first here. `no_point`: the form and the truth do
/// not meet the same solid there, or the point is not finite.
enum class Shown : std::uint8_t { no_point, self_hit, lost, by_form, wrong_side, safe };
inline constexpr std::array<const char*, 6> shown_labels{"no point that counts",
                                                         "self-hit by truth",
                                                         "past a neighbour, or past its own far side",
                                                         "self-hit or lost by the form's arithmetic alone",
                                                         "starts on the wrong side, without harm",
                                                         "every ray is right"};

[[nodiscard]] Shown shown_of(const measure::offset::OffsetBand& band, std::size_t pixel, measure::offset::Side side,
                             std::size_t strategy);
[[nodiscard]] image::Rgb8 colour_of(Shown shown);
/// Points in pictures that are drawn with the strategy's counts.
[[nodiscard]] std::vector<image::LegendEntry> shown_legend(std::span<const std::uint64_t> counts, std::uint64_t pixels);
[[nodiscard]] std::vector<image::LegendEntry> widest_shown_legend(std::uint64_t pixels);

/// The smallest safe offset in ulps of the largest coordinate, 2^-2 to 2^14, clamped.
[[nodiscard]] image::ColourScale safe_scale(image::ImageBackend& backend);
inline constexpr const char* safe_unit = "ulps of the largest coordinate";
/// What has no place on that scale.
enum class Needed : std::uint8_t { no_point, nothing, never, some };
[[nodiscard]] Needed needed_of(const measure::offset::OffsetBand& band, std::size_t pixel, measure::offset::Side side);
[[nodiscard]] image::Rgb8 safe_colour(const image::ColourScale& scale, const measure::offset::OffsetBand& band,
                                      std::size_t pixel, measure::offset::Side side);
/// `counts` in the order of `Needed`.
[[nodiscard]] std::vector<image::LegendEntry> needed_legend(std::span<const std::uint64_t> counts,
                                                            std::uint64_t pixels);
[[nodiscard]] std::vector<image::LegendEntry> widest_needed_legend(std::uint64_t pixels);

}  // namespace lostbits::output::offset
