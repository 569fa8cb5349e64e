// Measures one row on a band that shares the columns of its truth with other rows.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "measure/columns/columns.hpp"
#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::evaluate {

/// A band and its inputs and columns for one row.
struct RowBand {
    const truth::Band& band;
    const truth::FormatInputs& inputs;    ///< inputs in the row's format
    const columns::BandColumns& columns;  ///< computed for the row's convention and unit
};

/// Inputs of each format, and truths in the units and by the conventions of the rows, for measuring rows on a band. The
/// band must outlive this object.
class BandOfRows {
public:
    /// Also computes κ of the band's hits if a metric needs it.
    BandOfRows(truth::Band& band, const std::vector<TestedForm>& rows,
               const std::vector<const metric::Metric*>& metrics);

    [[nodiscard]] RowBand of(const TestedForm& row) const { return {band_, inputs_.at(row.format.name), columns_}; }

private:
    const truth::Band& band_;
    std::map<std::string, truth::FormatInputs> inputs_;
    columns::BandColumns columns_;
};

/// Rays of a band, by ascending index, that get a summary of their own as well.
struct BandPart {
    std::span<const std::uint32_t> rays;
    FormSummary* summary;
};

/// Same as `measure_row` of evaluate.hpp, which computes the columns for one row only.
void measure_row(const RowRequest& request, const RowBand& on, FormSummary& summary,
                 std::span<const BandPart> parts = {});

}  // namespace lostbits::measure::evaluate
