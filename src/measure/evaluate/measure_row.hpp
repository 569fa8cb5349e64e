// One row on a band whose truth is shared as columns with other rows.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "measure/columns/columns.hpp"
#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::evaluate {

/// A band as rows are measured on it.
struct RowBand {
    const truth::Band& band;
    const truth::FormatInputs& inputs;    ///< of the row's format
    const columns::BandColumns& columns;  ///< found for the row's convention and unit
};

/// What rows are given of a band, which outlives this, to be measured by some metrics: the inputs of each format, and
/// the truth in the units and by the conventions of the rows.
class BandOfRows {
public:
    /// κ of the band's hits is found too, where a metric needs it.
    BandOfRows(truth::Band& band, const std::vector<TestedForm>& rows,
               const std::vector<const metric::Metric*>& metrics);

    [[nodiscard]] RowBand of(const TestedForm& row) const { return {band_, inputs_.at(row.format.name), columns_}; }

private:
    const truth::Band& band_;
    std::map<std::string, truth::FormatInputs> inputs_;
    columns::BandColumns columns_;
};

/// Some rays of a band, by their places and rising, that are summed up by themselves too.
struct BandPart {
    std::span<const std::uint32_t> rays;
    FormSummary* summary;
};

/// As `measure_row` of evaluate.hpp, which finds the columns for one row alone.
void measure_row(const RowRequest& request, const RowBand& on, FormSummary& summary,
                 std::span<const BandPart> parts = {});

}  // namespace lostbits::measure::evaluate
