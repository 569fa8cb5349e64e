// Files of the map of one scene: heatmaps, pixel CSV, contact sheet, summary.csv and datapackage.json, together with
// the EXR.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/evaluate/map.hpp"
#include "output/file/csv.hpp"
#include "output/map/map_colour.hpp"
#include "output/map/map_exr.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::output::map {

struct MapFilesOptions {
    std::filesystem::path folder;  ///< folder of the scene; created if missing
    /// Metrics on sheets; metrics that are drawn alike share a sheet. The first metric is also the preview.
    std::vector<const Metric*> drawn_metrics;
    bool draws_single_pictures = false;  ///< also a picture of each metric of each row
    bool writes_pixels_csv = false;      ///< a row per pixel in `<form>.<format>.csv`
    std::string scene_arguments;         ///< names the scene to `lostbits explain`: an id and perhaps options
    /// The sheet of this run that explains p99, the order of forms and worst pixels; empty: this one.
    std::string sheet_with_explanations = {};
    /// Draws lost bits in a paler colour where the problem explains them (`is_inside_envelope`). Needs `excess_bits`.
    bool draws_envelope = false;
    MapExr* exr = nullptr;  ///< for the same study; filled, and closed before summary.csv; null: no EXR is written
    /// Tables that other objects write into the folder, for datapackage.json.
    std::vector<file::DataResource> other_tables = {};
    RayArguments ray_arguments = {};       ///< replaces `scene_arguments` if the rays come from a file
    bool is_list = false;                  ///< the rays are a list and not a picture, so no picture is drawn
    std::optional<BarRange> range = {};    ///< for every colour bar; absent: what fits each format
    pixel::PieceReceiver keep_piece = {};  ///< receives the pieces of a shard
    std::string group_column = {};         ///< column whose values group the rays; empty: none
    /// If set, the path of the only file: the sheet of lost bits. Nothing else is drawn, and the legend leaves out
    /// correct hits without a value.
    std::filesystem::path sheet_only_file = {};
};

/// Opens every file of a map at once, before any work. Receives the bands of all tested forms, and gives all files
/// their final names in `finish`. If the object is destroyed without `finish`, no file gets its final name.
class MapWriter {
public:
    MapWriter(const MapStudy& study, const MapFilesOptions& options);
    ~MapWriter();
    MapWriter(const MapWriter&) = delete;
    MapWriter& operator=(const MapWriter&) = delete;

    /// Returns the function that receives the bands of the study's rows.
    [[nodiscard]] measure::evaluate::ShowForms show();
    /// Writes the next piece of a row, which another run kept.
    void put(std::size_t form_index, pixel::Piece&& piece);
    void finish(const std::vector<FormSummary>& summaries, const measure::evaluate::Groups& groups = {});

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::map
