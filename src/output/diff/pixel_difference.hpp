// Two maps of the same pixels as one picture: where a form loses more bits, where fewer, and whose decisions changed.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "output/image/colour.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::diff {

/// The pixels of one form and format of a map.
struct PixelField {
    int width = 0, height = 0;
    std::vector<std::uint8_t> outcome;  ///< as `Outcome`
    std::vector<double> lost;           ///< bits; NaN but for agreed hits
};

/// From `FORM.FORMAT.csv` in the folder of a map, or from the part of that name in its EXR; nothing where it has
/// neither. InputError where the file is not one that a map writes.
[[nodiscard]] std::optional<PixelField> read_pixels(const std::filesystem::path& folder, const std::string& row);

/// Blue where the second loses fewer bits, white where both lose the same, orange where it loses more.
[[nodiscard]] std::vector<image::Rgb8> difference_ramp();

/// What has no difference of bits: fixed colours, off the ramp.
enum class PixelClass : std::uint8_t { both_miss, both_wrong, wrong_now, right_now };
inline constexpr std::array<image::Rgb8, 4> pixel_class_colours{{
    {150, 150, 150},  // both_miss: darker than in a map, since this ramp is white in the middle
    {80, 80, 80},     // both_wrong
    {0, 0, 0},        // wrong_now
    {240, 228, 66},   // right_now: yellow
}};

struct DifferenceWords {
    std::string title, first, second;  ///< what the picture shows, and what the sides are called
};

/// Writes the picture. The ramp's ends are the largest difference, at least one bit. InputError where the two are not
/// of one size.
void draw_difference(const std::filesystem::path& path, const PixelField& a, const PixelField& b,
                     const DifferenceWords& words);

}  // namespace lostbits::output::diff
