// What the page shows as a grid of cells: sweeps over two axes, and named cases.
#pragma once

#include <string>
#include <vector>

#include "measure/sweep/cases.hpp"
#include "measure/sweep/sweep.hpp"

namespace lostbits::output::page {

/// A sweep over two axes, as JSON: the axes with their values, rising; and of every row the outcomes and
/// `sweep_statistics` of each cell, lines of the lowest second value first.
[[nodiscard]] std::string plane_json(const measure::sweep::SweepRequest& request,
                                     const std::vector<measure::sweep::SweepStep>& steps);

/// Named cases, as JSON: their names, and of every row (by each convention) verdict, outcomes and `sweep_statistics` of
/// each.
[[nodiscard]] std::string case_json(const measure::sweep::CaseRequest& request,
                                    const std::vector<std::vector<measure::map::MapSummary>>& cases);

}  // namespace lostbits::output::page
