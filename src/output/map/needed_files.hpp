// The files of `--bits-needed`: a heatmap a form, and needed.csv; parts of the EXR.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "measure/evaluate/needed.hpp"
#include "output/file/csv.hpp"
#include "output/image/colour.hpp"
#include "output/map/map_exr.hpp"

namespace lostbits::output::map {

/// A pixel on which not even 53 bits suffice: dark green, as far from the ramp and from every outcome's colour as those
/// are from each other (a test holds it).
inline constexpr image::Rgb8 beyond_colour{0, 45, 0};

struct NeededFilesOptions {
    std::filesystem::path folder;  ///< of this scene; made if missing
    bool pixels_csv = false;       ///< a row per pixel in `<form>.needed.csv`
    MapExr* exr = nullptr;         ///< of the same request; null: none is written
    KeepPiece keep = {};           ///< of a shard
};

/// `<form>.needed.png`: the width on viridis from 2 to 53. `needed.csv`: a row per form. With an EXR also the parts
/// `<form>.needed` of it. Opened, served and finished as MapFiles; finish it before the map of the same folder, which
/// closes the EXR and whose summary.csv says that all is there.
class NeededFiles {
public:
    NeededFiles(const measure::evaluate::NeededRequest& request, const NeededFilesOptions& options);
    ~NeededFiles();
    NeededFiles(const NeededFiles&) = delete;
    NeededFiles& operator=(const NeededFiles&) = delete;

    /// The next band of a form.
    void band(std::size_t form, const measure::evaluate::NeededBand& result);
    /// The next piece of a form, as another run kept it.
    void put(std::size_t form, MapPiece&& piece);
    /// For the folder's datapackage.json.
    [[nodiscard]] std::vector<file::DataResource> resources() const;
    void finish(const std::vector<measure::evaluate::NeededSummary>& summaries);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::map
