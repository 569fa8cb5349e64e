// What the two halves of the image module share; no part of the program includes it.
#pragma once

#include <memory>
#include <string>

#include "output/image/image.hpp"

namespace lostbits::output::image {

/// The writers behind ImageBackend::open_exr and open_png. Bytes go to `sink`; `path` is for messages.
[[nodiscard]] std::unique_ptr<ExrWriter> oiio_exr(std::unique_ptr<file::ByteSink> sink, const std::string& path,
                                                  const ExrSpec& spec);
[[nodiscard]] std::unique_ptr<PngWriter> oiio_png(std::unique_ptr<file::ByteSink> sink, const std::string& path,
                                                  const PngSpec& spec);

}  // namespace lostbits::output::image
