// The files of offsets along an axis: a table, and two plots for each row and side.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/offset/along.hpp"
#include "measure/offset/offsets.hpp"
#include "output/offset/offset_files.hpp"

namespace lostbits::output::offset {

/// A strategy at a place on the axis.
struct PlaceRow {
    double place;
    StrategyRow of;
};

/// `along.<axis>.csv` is the summary with the place on the axis in front; `along.<axis>.<row>.<side>.wrong.png` the
/// share of rays that go wrong, and `….size.png` the offsets beside the smallest safe one.
class AlongFiles {
public:
    /// Opens the table. `request`, of the scene as it is, must outlive it.
    AlongFiles(const std::filesystem::path& folder, const measure::offset::OffsetRequest& request,
               measure::offset::Along along);

    void add(double k, std::vector<measure::offset::OffsetSummary> summaries);
    /// Draws the plots and gives the table its final name.
    void finish();
    [[nodiscard]] const file::DataResource& resource() const { return table_.about(); }

private:
    void plot_wrong(std::size_t row, measure::offset::Side side) const;
    void plot_size(std::size_t row, measure::offset::Side side) const;
    [[nodiscard]] std::filesystem::path file_of(std::size_t row, measure::offset::Side side, const char* what) const;

    std::filesystem::path folder_;
    const measure::offset::OffsetRequest& request_;
    measure::offset::Along along_;
    table::TableFile<PlaceRow> table_;
    std::vector<double> steps_;
    std::vector<std::vector<measure::offset::OffsetSummary>> summaries_;  ///< step by step
};

}  // namespace lostbits::output::offset
