// Sweeps, planes of two axes, named cases and trades, as JSON for the page.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "measure/sweep/sweep.hpp"
#include "measure/trade/trade.hpp"
#include "output/report/text.hpp"

namespace lostbits::output::report {

using measure::evaluate::FormSummary;
using measure::sweep::Onset;
using measure::sweep::SweepRequest;

/// Columns of a sweep's samples.csv that the page shows.
inline constexpr std::array<std::string_view, 7> sweep_statistics{
    "lost_bits_p50",     "lost_bits_p99",      "lost_bits_max",      "excess_bits_p99",
    "inherent_bits_p99", "false_hit_fraction", "false_miss_fraction"};

/// A sweep along one axis: the axis with its values, and for every row the outcomes and each statistic at every step.
[[nodiscard]] Json sweep_json(const SweepRequest& request, const std::vector<measure::sweep::SweepStep>& steps,
                              const std::vector<Onset>& onsets);

/// A sweep over two axes: the axes with their values in rising order, and for every row the outcomes and
/// `sweep_statistics` of each cell. The line of the lowest second value comes first.
[[nodiscard]] Json plane_json(const SweepRequest& request, const std::vector<measure::sweep::SweepStep>& steps);

/// Named cases: their names, and for every row (under each convention) the verdict, the outcomes and `sweep_statistics`
/// of each case.
[[nodiscard]] Json case_json(const measure::sweep::CaseRequest& request,
                             const std::vector<std::vector<FormSummary>>& cases);

/// HTML table with a line per row of the sweep: the values at which errors first occur.
[[nodiscard]] std::string onset_table(const SweepRequest& request, const std::vector<Onset>& onsets);

/// Points of a trade for each set of rays: time, kept bits and wrong decisions.
[[nodiscard]] Json trade_json(const measure::trade::TradeRequest& request, const measure::trade::TradeResult& result);

}  // namespace lostbits::output::report
