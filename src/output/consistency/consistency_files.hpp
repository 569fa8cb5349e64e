// The files of questions put in two ways over a scene: pictures, the contact sheet, one row per pixel, summary.csv.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "measure/consistency/consistency.hpp"

namespace lostbits::output::consistency {

struct ConsistencyFilesOptions {
    std::filesystem::path folder;  ///< of this scene; made if missing
    bool pixels_csv = false;       ///< also one row per pixel
    bool singles = false;          ///< also a picture for each cell of the sheet
};

/// Opens every file at once, before any work, and gives all their final names in `finish`.
///
/// The pictures are those of `ConsistencyPictures`; `<form>.<format>.csv` has one row per pixel.
class ConsistencyFiles final : public measure::consistency::ConsistencySink {
public:
    ConsistencyFiles(const measure::consistency::ConsistencyRequest& request, const ConsistencyFilesOptions& options);
    ~ConsistencyFiles() override;
    ConsistencyFiles(const ConsistencyFiles&) = delete;
    ConsistencyFiles& operator=(const ConsistencyFiles&) = delete;

    void band(std::size_t row, const measure::consistency::ConsistencyBand& band) override;
    void finish(const std::vector<measure::consistency::RowChecks>& rows);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::consistency
