// Time against kept bits on a set of rays, as a picture.
#pragma once

#include <filesystem>

#include "measure/speed/trade.hpp"
#include "output/plot/scatter_plot.hpp"

namespace lostbits::output {

/// What is drawn: markers by register width, colours by format; grey what is dominated, hollow what decides any ray wrongly.
/// The stepped line joins what is not dominated; it is dashed between those that are sometimes wrong.
ScatterPlotSpec trade_plot(const TradeRequest& request, const TradeResult& result, std::size_t set);
void write_trade_plot(const std::filesystem::path& path, const TradeRequest& request, const TradeResult& result, std::size_t set);

}  // namespace lostbits::output
