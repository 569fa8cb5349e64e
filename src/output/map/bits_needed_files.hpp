// Files of `lostbits map --bits`, which measures how many significand bits each form needs: a heatmap per form,
// needed.csv, and parts of the EXR.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "measure/evaluate/bits_needed.hpp"
#include "output/file/csv.hpp"
#include "output/image/colour.hpp"
#include "output/map/map_exr.hpp"

namespace lostbits::output::map {

/// Colour of a pixel for which not even 53 bits suffice: dark green. It is as far from the ramp and from the colour of
/// every outcome as these colours are from each other; a test checks this.
inline constexpr image::Rgb8 beyond_colour{0, 45, 0};

struct BitsNeededFilesOptions {
    std::filesystem::path folder;          ///< folder of the scene; created if missing
    bool writes_pixels_csv = false;        ///< a row per pixel in `<form>.needed.csv`
    MapExr* exr = nullptr;                 ///< for the same study; null: no EXR is written
    pixel::PieceReceiver keep_piece = {};  ///< receives the pieces of a shard
};

/// Writes `<form>.needed.png`, which shows the width on viridis from 2 to 53; `needed.csv`, a row per form; and the
/// parts `<form>.needed` of an EXR, if there is one. The object is opened, filled and finished like MapWriter. Finish
/// it before the map of the same folder, which closes the EXR and whose summary.csv marks the folder as complete.
class BitsNeededWriter {
public:
    BitsNeededWriter(const measure::evaluate::BitsNeededStudy& study, const BitsNeededFilesOptions& options);
    ~BitsNeededWriter();
    BitsNeededWriter(const BitsNeededWriter&) = delete;
    BitsNeededWriter& operator=(const BitsNeededWriter&) = delete;

    /// Returns the function that receives the bands of the forms.
    [[nodiscard]] measure::study::ShowBand<measure::evaluate::BitsNeededStudy> show();
    /// Writes the next piece of a form, which another run kept.
    void put(std::size_t form, pixel::Piece&& piece);
    /// Tables for the folder's datapackage.json.
    [[nodiscard]] std::vector<file::DataResource> resources() const;
    void finish(const std::vector<measure::evaluate::BitsNeededSummary>& summaries);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::map
