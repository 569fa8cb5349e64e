// The files of a map: heatmaps, pixel CSV, contact sheet, summary.csv and datapackage.json of one scene; with the EXR.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "output/file/csv.hpp"
#include "output/map/map_colour.hpp"
#include "output/map/map_exr.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::output::map {

struct MapFilesOptions {
    std::filesystem::path folder;  ///< of this scene; made if missing
    std::vector<const measure::metric::Metric*>
        drawn;                ///< on sheets, those that are drawn alike on one; the first is also the preview's
    bool singles = false;     ///< also a picture of each metric of each row
    bool pixels_csv = false;  ///< a row per pixel in `<form>.<format>.csv`
    std::string named;        ///< what names the scene to `lostbits explain`: a word and perhaps options
    /// Draws lost bits paler where the problem explains them (`inside_envelope`); `excess_bits` must be measured then.
    bool envelope = false;
    MapExr* exr = nullptr;  ///< of the same request; filled and, before summary.csv, closed; null: none is written
    std::vector<file::DataResource> also = {};  ///< tables that others write into the folder, for datapackage.json
    NameOfRay name_of_ray = {};                 ///< in place of `named`, where the rays are those of a file
    bool listed = false;                        ///< the rays are a list and no picture: none is drawn
    std::optional<BarRange> range = {};         ///< of every colour bar; absent: what fits each format
    KeepPiece keep = {};                        ///< of a shard
    std::string by = {};                        ///< the column whose values rays are grouped by; empty: none
    /// A file: the sheet of lost bits there, which is all that is drawn, is the only one. Its legend leaves out correct
    /// hits without a value.
    std::filesystem::path sheet_alone = {};
};

/// Opens every file of a map at once, before any work; is shown its rows; and gives all files their final names in
/// `finish`. Destroyed without `finish`, it leaves nothing under a final name.
class MapFiles {
public:
    MapFiles(const measure::evaluate::EvaluationRequest& request, const MapFilesOptions& options);
    ~MapFiles();
    MapFiles(const MapFiles&) = delete;
    MapFiles& operator=(const MapFiles&) = delete;

    /// What takes the bands of each row of the request, in its order.
    [[nodiscard]] std::vector<measure::evaluate::Show> shows();
    /// The next piece of a row, as another run kept it.
    void put(std::size_t row, MapPiece&& piece);
    void finish(const std::vector<measure::evaluate::FormSummary>& summaries,
                const measure::evaluate::Groups& groups = {});

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::map
