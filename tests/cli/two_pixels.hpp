// Pictures of two pixels, for what compares pictures.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>

#include "output/image/image.hpp"

namespace lostbits::test {

inline output::image::ImageBackend& backend() {
    setenv("LOSTBITS_IMAGE_MODULE", LOSTBITS_IMAGE_MODULE_FILE, 1);
    return output::image::image_backend();
}

/// The second pixel ends in `blue`.
inline void write_png(const std::filesystem::path& path, std::uint8_t blue) {
    auto png = backend().open_png(path, 2, 1);
    const output::image::Rgb8 pixels[] = {{1, 2, 3}, {4, 5, blue}};
    png->write_rows(1, pixels);
    png->close();
}

}  // namespace lostbits::test
