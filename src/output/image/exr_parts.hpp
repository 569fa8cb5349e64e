// What all EXR files of the laboratory have: words for samples, a preview, the compiler.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

#include "output/image/colour.hpp"

namespace lostbits::output::image {

/// The sample of a FLOAT channel: x rounded once to binary32.
[[nodiscard]] inline std::uint32_t float_word(double x) { return std::bit_cast<std::uint32_t>(static_cast<float>(x)); }

/// The samples of R, G and B: linear light.
[[nodiscard]] inline std::array<std::uint32_t, 3> preview_words(Rgb8 c) {
    const auto word = [](std::uint8_t srgb) { return float_word(linear_light(srgb) / 65535.0); };
    return {word(c.r), word(c.g), word(c.b)};
}

/// `lostbits:compiler`: what the program was built with.
[[nodiscard]] std::pair<std::string, std::string> compiler_attribute();

/// `lostbits:objects`: how a channel names a solid. 0 is none, as in a layer that nothing was painted on.
[[nodiscard]] std::pair<std::string, std::string> objects_attribute();

}  // namespace lostbits::output::image
