// Sweeps and trades as the page holds them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "measure/sweep/sweep.hpp"
#include "measure/speed/trade.hpp"

namespace lostbits::output::report {

/// A column of a sweep's samples.csv that the page plots.
struct Statistic {
    const char* name;
    double (*of)(const MapSummary& summary, const std::vector<const Metric*>& metrics);
};
[[nodiscard]] const std::vector<Statistic>& sweep_statistics();

/// `"form":…,"format":…,"values":[statistic][cell],"outcomes":[cell][outcome]`: the numbers of a row at every step, cell or case.
[[nodiscard]] std::string row_fields(const MapRow& row, const std::vector<const Metric*>& metrics, std::size_t cells, const std::function<const MapSummary&(std::size_t)>& at);

/// A sweep along one axis: the axis with its values, and of every row outcomes and each statistic at every step, as JSON.
[[nodiscard]] std::string sweep_json(const SweepRequest& request, const std::vector<SweepStep>& steps, const std::vector<Onset>& onsets);

/// A table of a row each, with the places where things first go wrong, as HTML.
[[nodiscard]] std::string onset_table(const SweepRequest& request, const std::vector<Onset>& onsets);

/// What is plotted of a trade, for each set of rays: time, kept bits, wrong decisions and what nothing beats, as JSON.
[[nodiscard]] std::string trade_json(const TradeRequest& request, const TradeResult& result);

}  // namespace lostbits::output::report
