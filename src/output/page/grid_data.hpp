// What the page shows as a grid of cells: sweeps over two axes, and named cases.
#pragma once

#include <vector>

#include "measure/sweep/sweep.hpp"
#include "output/page/json.hpp"

namespace lostbits::output::page {

/// A sweep over two axes: the axes with their values, rising; and of every row the outcomes and
/// `sweep_statistics` of each cell, lines of the lowest second value first.
[[nodiscard]] Json plane_json(const measure::sweep::SweepRequest& request,
                              const std::vector<measure::sweep::SweepStep>& steps);

/// Named cases: their names, and of every row (by each convention) verdict, outcomes and `sweep_statistics` of
/// each.
[[nodiscard]] Json case_json(const measure::sweep::CaseRequest& request,
                             const std::vector<std::vector<measure::evaluate::FormSummary>>& cases);

}  // namespace lostbits::output::page
