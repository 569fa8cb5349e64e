// All checks of a scene on one page, and a picture each.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/consistency/consistency.hpp"
#include "output/pixel/columns.hpp"

namespace lostbits::output::consistency {

/// Checks across; forms and formats down.
class ConsistencyPictures final : public measure::consistency::ConsistencySink {
public:
    /// Opens the sheet and, in the folder `singles`, `<form>.<format>.<check>.png` for each of its cells. `request`
    /// must outlive it.
    ConsistencyPictures(const measure::consistency::ConsistencyRequest& request, const std::filesystem::path& sheet,
                        const std::filesystem::path& singles = {});

    void band(std::size_t row, const measure::consistency::ConsistencyBand& band) override {
        files_.take(row, band, band.y0, band.checks.front().accord.size());
    }
    /// Draws the page and gives the files their final names.
    void finish(const std::vector<measure::consistency::RowChecks>& rows);

private:
    const measure::consistency::ConsistencyRequest& request_;
    pixel::ColumnFiles<measure::consistency::ConsistencyBand> files_;
};

}  // namespace lostbits::output::consistency
