// Readers of pictures: those that tests write and those of the program.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "catch.hpp"
#include "output/image/image.hpp"
#include "program.hpp"

namespace lostbits::test {

inline output::image::ImageBackend& backend() {
    draw_pictures();
    return output::image::image_backend();
}

/// Two pixels, the second of which ends in `blue`.
inline void write_png(const fs::path& path, std::uint8_t blue) {
    auto png = backend().open_png(path, 2, 1);
    const output::image::Rgb8 pixels[] = {{1, 2, 3}, {4, 5, blue}};
    png->write_rows(1, pixels);
    png->close();
}

inline std::size_t count_of(const output::image::PngImage& png, output::image::Rgb8 colour) {
    return static_cast<std::size_t>(std::ranges::count(png.pixels, colour));
}

/// The part with that name.
inline output::image::ExrImage read_part(const fs::path& path, const std::string& name) {
    const auto names = backend().exr_parts(path);
    return backend().read_exr(path, static_cast<std::size_t>(std::ranges::find(names, name) - names.begin()));
}

template <class Sample>
const std::vector<Sample>& samples(const output::image::ExrImage& exr, const std::string& name) {
    const auto* channel = exr.find(name);
    CAPTURE(name);
    REQUIRE(channel != nullptr);
    return std::get<std::vector<Sample>>(channel->samples);
}

/// The text of an attribute; empty if the image does not have it.
inline std::string attribute(const output::image::ExrImage& exr, const std::string& name) {
    for (const auto& [key, value] : exr.attributes)
        if (key == name) return value;
    return {};
}

}  // namespace lostbits::test
