// The EXR of a scene's map: every value that the pictures show, with one part per tested form (a form in a format).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/evaluate/bits_needed.hpp"
#include "measure/evaluate/map.hpp"
#include "output/image/colour.hpp"
#include "output/image/exr_book.hpp"
#include "output/pixel/columns.hpp"
#include "output/pixel/exr_layers.hpp"
#include "output/pixel/form_files.hpp"

namespace lostbits::output::map {

using measure::evaluate::BandResult;
using measure::evaluate::BitsNeededBand;
using measure::evaluate::MapStudy;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

using pixel::ExrScanlines;

/// Values that an EXR holds, and the command that measured them.
struct MapExrRequest {
    const MapStudy& map;
    std::vector<const Metric*> layers;                           ///< a selection of the map's metrics
    std::string command;                                         ///< the command that makes the file again
    const measure::evaluate::BitsNeededStudy* needed = nullptr;  ///< null: the bits needed are not measured
};

/// A band of results and the preview of its pixels, which become rows of a part.
template <class Result>
struct PreviewedBand {
    const Result* result;
    std::span<const image::Rgb8> preview;
};
using MapStrip = PreviewedBand<BandResult>;
using BitsNeededStrip = PreviewedBand<BitsNeededBand>;

/// The EXR file of a map. It has these parts, in this order, with channels of 32 bits:
/// - `<form>.<format>`, one per tested form: `R`, `G`, `B` (the heatmap in linear light); the answer t (below);
/// `class.outcome`; `class.object` (UINT; 0 is none, otherwise 1 + the index of the primitive, counted from 0); one
/// FLOAT channel per metric, NaN where it is undefined. The attribute `lostbits:truth` names the part with the tested
/// form's truth.
/// - `truth…`, one for each convention of the tested forms: t* correctly rounded to binary64, `class.truth` (UINT: 0
/// miss, 1 hit, 2 unresolved), `class.truth_object`. In `truth.distance` t* is a distance, for unit-direction forms.
/// - `<form>.needed`: `R`, `G`, `B`, `bits.needed` (FLOAT: 2 to 53, infinity if not even 53 suffice, NaN if the truth
/// is unresolved), `class.truth`, `class.truth_object`.
/// A number x is stored as `x.hi` (FLOAT). If binary32 cannot represent its format, there are also `x.lo` (hi + lo is
/// good to 48 bits, for viewers), and `x.word1` and `x.word0` (UINT, the high and low halves of the binary64, exact).
class MapExr {
public:
    /// Without a path no file is written; only `make_rows` may be called.
    MapExr(const std::filesystem::path& path, const MapExrRequest& request);
    ~MapExr();
    MapExr(const MapExr&) = delete;
    MapExr& operator=(const MapExr&) = delete;

    /// Rows of the file for one band: of a tested form of the map, with its truth unless another tested form writes
    /// that truth; or of the bits needed by a form.
    [[nodiscard]] std::vector<ExrScanlines> make_rows(const TestedForm& tested_form, const BandResult& result,
                                                      std::span<const image::Rgb8> preview) const;
    [[nodiscard]] std::vector<ExrScanlines> make_rows(const BitsNeededBand& result,
                                                      std::span<const image::Rgb8> preview) const;
    /// Writes the next rows of the parts. Different parts may be written concurrently.
    void write(const std::vector<ExrScanlines>& part_rows);
    void close();

private:
    struct SeriesLayers {
        const TestedForm* tested_form;
        pixel::ExrLayers<MapStrip> layers;
    };
    struct TruthPart;
    std::vector<SeriesLayers> series_;
    std::vector<TruthPart> truth_parts_;
    std::vector<const intersect::Info*> needed_forms_;
    std::unique_ptr<image::ExrBook> book_;
};

}  // namespace lostbits::output::map
