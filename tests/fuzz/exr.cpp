#include "fuzz/fuzz.hpp"
#include "output/image/image_oiio.hpp"

namespace lostbits::fuzz {

/// Every part of an EXR file, as `diff` reads it. The library behind it is not instrumented: the test covers the calls
/// of the library and the checks of its answers.
void fuzz_exr(std::string_view bytes) {
    const std::filesystem::path path = file_of(bytes);
    output::image::ImageBackend& images = output::image::image_backend();
    answer_or_error([&] {
        if (output::image::ExrHeads(path).pixels() > 100'000) return;  // reading so many takes long, as expected
        const std::size_t parts = std::min<std::size_t>(images.exr_parts(path).size(), 4);
        for (std::size_t part = 0; part < parts; ++part) {
            const output::image::ExrImage image = images.read_exr(path, part);
            const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
            for (const auto& channel : image.channels)
                if (std::visit([](const auto& samples) { return samples.size(); }, channel.samples) != pixels)
                    throw std::logic_error("a channel has not a sample a pixel");
        }
    });
}

}  // namespace lostbits::fuzz
