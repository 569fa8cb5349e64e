// Parts common to all EXR files of lostbits: sample words, a preview, the compiler.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

#include "output/image/colour.hpp"

namespace lostbits::output::image {

/// Sample of a FLOAT channel: x rounded once to binary32.
[[nodiscard]] inline std::uint32_t float_word(double x) { return std::bit_cast<std::uint32_t>(static_cast<float>(x)); }

/// Samples of R, G and B: the colour in linear light.
[[nodiscard]] inline std::array<std::uint32_t, 3> preview_words(Rgb8 c) {
    const auto word = [](std::uint8_t srgb) { return float_word(linear_light(srgb) / 65535.0); };
    return {word(c.r), word(c.g), word(c.b)};
}

/// `lostbits:compiler`: the compiler and options that built the program.
[[nodiscard]] std::pair<std::string, std::string> compiler_attribute();

/// `lostbits:objects`: how a channel numbers the primitives. 0 means none, as in a layer on which nothing is painted.
[[nodiscard]] std::pair<std::string, std::string> objects_attribute();

}  // namespace lostbits::output::image
