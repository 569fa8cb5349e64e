// One row on a band whose truth is shared as columns with other rows.
#pragma once

#include "measure/columns/columns.hpp"
#include "measure/map/map.hpp"

namespace lostbits::measure::map {

/// A band as rows are measured on it.
struct RowBand {
    const truth::Band& band;
    const truth::FormatInputs& inputs;    ///< of the row's format
    const columns::BandColumns& columns;  ///< found for the row's convention and unit
};

/// As the function of map.hpp, which finds the columns for one row alone.
void measure_row(const RowRequest& request, const RowBand& on, MapSummary& summary);

}  // namespace lostbits::measure::map
