// Divides a picture into bands: blocks of scanlines that are measured together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "measure/culling/culling.hpp"
#include "measure/shard/share.hpp"
#include "measure/truth/band.hpp"

namespace lostbits::measure::study {

/// Approximate number of pixels of a band of a map.
inline constexpr int default_pixels_per_band = 32768;

/// Returns the number of scanlines of a band with about this number of pixels: a multiple of 16, the number of lines in
/// a block of an EXR file, and at least 16.
inline int lines_per_band(int width, int pixels = default_pixels_per_band) {
    constexpr int block = 16;
    return std::max(block, (pixels / width + block - 1) / block * block);
}

/// Bands of a share of a scene's picture, from top to bottom. Where bands begin depends only on the picture, not on the
/// share or the number of threads.
class Bands {
public:
    /// The scene must outlive the bands.
    explicit Bands(const scene::file::Scene& scene, shard::Share share = {}, int pixels = default_pixels_per_band)
        : scene_(scene),
          lines_(lines_per_band(scene.width, pixels)),
          units_(share.unit_range(static_cast<std::uint64_t>((scene.height + lines_ - 1) / lines_))) {}

    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(units_.last - units_.first); }

    /// Returns band k of the share with its truth. `culler` must outlive it.
    [[nodiscard]] truth::Band at(std::size_t k, truth::ProofLimit limit, culling::Culler& culler) const {
        const int y0 = static_cast<int>(units_.first + k) * lines_;
        return {scene_, y0, std::min(scene_.height, y0 + lines_), limit, &culler};
    }

    /// Calls `measure` with each band, one after another.
    template <class Measure>
    void for_each_band(truth::ProofLimit limit, const Measure& measure) const {
        culling::Culler culler(scene_);
        for (std::size_t k = 0; k < size(); ++k) {
            truth::Band band = at(k, limit, culler);
            measure(band);
        }
    }

private:
    const scene::file::Scene& scene_;
    int lines_;
    shard::UnitRange units_;
};

}  // namespace lostbits::measure::study
