// Parts that all EXR files of lostbits share: samples as 32-bit words, samples of the preview, and attributes.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

#include "output/image/colour.hpp"

namespace lostbits::output::image {

/// Sample of a FLOAT channel: the bits of x, rounded once to binary32.
[[nodiscard]] inline std::uint32_t float_word(double x) { return std::bit_cast<std::uint32_t>(static_cast<float>(x)); }

/// Samples of the preview channels R, G and B: the colour in linear light.
[[nodiscard]] inline std::array<std::uint32_t, 3> preview_words(Rgb8 c) {
    const auto word = [](std::uint8_t srgb) { return float_word(linear_light(srgb) / 65535.0); };
    return {word(c.r), word(c.g), word(c.b)};
}

/// `lostbits:compiler`: the compiler and options that built the program.
[[nodiscard]] std::pair<std::string, std::string> compiler_attribute();

/// The attribute `lostbits:objects`: how channels number primitives. 0 means no primitive, as on a layer on which
/// nothing is painted.
[[nodiscard]] std::pair<std::string, std::string> primitives_attribute();

}  // namespace lostbits::output::image
