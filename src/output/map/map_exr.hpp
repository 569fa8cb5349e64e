// The EXR of one row of a map: every value that the picture was made of.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/map/map.hpp"
#include "output/image/colour.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::map {

/// Channels, all 32 bits: `R`, `G`, `B` (the heatmap in linear light); `t.hi`, `t.lo` and `truth.hi`, `truth.lo`
/// (FLOAT, hi + lo, good to 48 bits, for viewers); `t.word1`, `t.word0` and `truth.word1`, `truth.word0` (UINT, the
/// high and low halves of the binary64, exact; the truth correctly rounded to it); `class.outcome`, `class.object`,
/// `class.truth_object` (UINT; objects from 1, 0 is none); and one FLOAT channel a metric, NaN where it does not exist.
/// t is the form's answer in its own unit, and the truth with it: a distance for unit-direction forms.
class MapExr {
public:
    MapExr(image::ImageBackend& backend, const std::filesystem::path& path, const measure::map::MapRequest& request,
           const measure::map::MapRow& row, const std::string& command);

    void write(const measure::map::BandResult& result, std::span<const image::Rgb8> preview);
    void close() { writer_->close(); }

private:
    const measure::map::MapRow* row_;
    std::size_t channels_;
    std::unique_ptr<image::ExrWriter> writer_;
    std::vector<std::uint32_t> samples_;
};

}  // namespace lostbits::output::map
