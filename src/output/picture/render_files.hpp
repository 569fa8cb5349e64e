// The files of a rendered scene: pictures, the certified picture, difference maps, EXR, contact sheet, summary.csv.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/picture/render.hpp"

namespace lostbits::output::picture {

struct RenderFilesOptions {
    std::filesystem::path folder;  ///< of this scene; made if missing
    std::string command;           ///< what to type to make these files again, for the EXR header
    bool singles = false;          ///< also each picture alone, and its difference maps
};

/// Opens every file at once, before any work, and gives all their final names in `finish`; see `MapFiles`.
/// The pictures are those of `RenderPictures`; `<form>.<format>.exr` has what they were made of.
class RenderFiles final : public measure::picture::RenderSink {
public:
    RenderFiles(const measure::picture::RenderRequest& request, const RenderFilesOptions& options);
    ~RenderFiles() override;
    RenderFiles(const RenderFiles&) = delete;
    RenderFiles& operator=(const RenderFiles&) = delete;

    void reference(int y0, int rows, std::span<const measure::picture::TruePixel> truth) override;
    void row(std::size_t row, const measure::picture::RenderBand& band) override;
    void finish(const std::vector<measure::picture::RenderSummary>& summaries);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::picture
