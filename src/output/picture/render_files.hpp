// The files of a rendered scene: pictures, the certified picture, difference maps, EXR, contact sheet, summary.csv.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/picture/render.hpp"
#include "output/picture/render_exr.hpp"
#include "output/picture/render_pictures.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::picture {

struct RenderFilesOptions {
    std::filesystem::path folder;  ///< of this scene; made if missing
    std::string command;           ///< what to type to make these files again, for the EXR header
    bool singles = false;          ///< also each picture alone, and its difference maps
};

struct StageRow {
    scene::file::Stage stage;
    const measure::evaluate::TestedForm* row;
    const measure::picture::RenderSummary* summary;
};

/// Opens every file at once, before any work, and gives all their final names in `finish`; see `MapFiles`.
/// The pictures are those of `RenderPictures`; `<form>.<format>.exr` has what they were made of.
class RenderFiles final : public measure::picture::RenderSink {
public:
    RenderFiles(const measure::picture::RenderRequest& request, RenderFilesOptions options);

    void reference(int y0, int rows, std::span<const measure::picture::TruePixel> truth) override {
        pictures_.reference(y0, rows, truth);
    }
    void row(std::size_t row, const measure::picture::RenderBand& band) override {
        pictures_.row(row, band);
        layers_[row].write(band);
    }
    void finish(const std::vector<measure::picture::RenderSummary>& summaries);

private:
    const measure::picture::RenderRequest& request_;
    RenderFilesOptions options_;
    table::TableFile<StageRow> table_;
    RenderPictures pictures_;
    std::vector<RenderExr> layers_;  ///< of each row
};

}  // namespace lostbits::output::picture
