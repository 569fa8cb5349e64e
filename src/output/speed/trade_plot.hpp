// Time against kept bits on a set of rays, as a picture.
#pragma once

#include <filesystem>
#include <string>

#include "measure/speed/trade.hpp"
#include "output/plot/scatter_plot.hpp"

namespace lostbits::output::speed {

/// The titles of its axes, here and on the page.
inline constexpr const char *time_title = "time per ray of the easy set, ns",
                            *scene_time_title = "time per ray and solid on the scene, ns",
                            *kept_title = "bits that 99 % of the hits keep";

/// `one ray at a time`, `256-bit registers`
std::string registers_of(const measure::speed::TradeKernel& kernel);

/// What is drawn: markers by register width, colours by format; grey what is dominated, hollow what decides any ray
/// wrongly. The stepped line joins what is not dominated; it is dashed between those that are sometimes wrong.
plot::ScatterPlotSpec trade_plot(const measure::speed::TradeRequest& request, const measure::speed::TradeResult& result,
                                 std::size_t set);
void write_trade_plot(const std::filesystem::path& path, const measure::speed::TradeRequest& request,
                      const measure::speed::TradeResult& result, std::size_t set);

}  // namespace lostbits::output::speed
