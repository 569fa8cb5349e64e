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

/// The truth of a band in the units and by the conventions of the rows.
columns::BandColumns columns_of(const truth::Band& band, const std::vector<TestedForm>& rows);

/// What the rows and metrics need of a band's inputs, by the names of the formats.
std::map<std::string, truth::BandNeeds> needs_by_format(const std::vector<TestedForm>& rows,
                                                        const std::vector<const metric::Metric*>& metrics);

/// Some rays of a band, by their places and rising, that are summed up by themselves too.
struct BandPart {
    std::span<const std::uint32_t> rays;
    FormSummary* summary;
};

/// As `measure_row` of evaluate.hpp, which finds the columns for one row alone.
void measure_row(const RowRequest& request, const RowBand& on, FormSummary& summary,
                 std::span<const BandPart> parts = {});

}  // namespace lostbits::measure::evaluate
