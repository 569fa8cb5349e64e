// The EXR of one form in one format: every number that its pictures and difference maps were made of.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "measure/picture/render.hpp"
#include "output/pixel/exr_layers.hpp"

namespace lostbits::output::picture {

/// Channels, all 32 bits: `R`, `G`, `B` (the last stage's picture in linear light); for each stage `<stage>.r`, `.g`,
/// `.b` (FLOAT, display numbers as the format computed them, not clamped), `<stage>_true.r`, `.g`, `.b` (the certified
/// ones) and
/// `<stage>.difference` (8-bit steps); `normal.angle`, `point.residual`; `class.seen`, `class.shadow` (UINT, in the
/// order of the attributes `lostbits:seen` and `lostbits:shadow`), `class.object`, `class.true_object` (0 is
/// none, otherwise 1 + the sphere's number, counted from 0).
class RenderExr {
public:
    RenderExr(const std::filesystem::path& path, const measure::picture::RenderRequest& request,
              const measure::evaluate::TestedForm& row, const std::string& command);

    void write(const measure::picture::RenderBand& band) {
        const auto samples = layers_.samples(band, band.seen.size());
        writer_->write_rows(band.y0, band.rows, std::as_bytes(std::span(samples)));
    }
    void close() { writer_->close(); }

private:
    pixel::ExrLayers<measure::picture::RenderBand> layers_;
    std::unique_ptr<image::ExrWriter> writer_;
};

}  // namespace lostbits::output::picture
