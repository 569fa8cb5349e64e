// The pictures of an exhaustive sweep: a level stretch a binade.
#pragma once

#include <filesystem>
#include <optional>

#include "measure/sweep/exhaustive.hpp"
#include "output/plot/line_plot.hpp"

namespace lostbits::output::sweep {

/// One float of a whole binade: the least share of it but 0, which has a place of its own.
inline constexpr double least_share = 0x1p-23;

struct ExhaustivePlots {
    plot::LinePlotSpec lost_bits;  ///< of the worst float of each binade
    plot::LinePlotSpec wrong;      ///< the share of a binade's tried floats with a wrong decision
};
/// A line a form, ray and sign, level from the smallest float of a binade that was tried to the largest. Zeros,
/// infinities and NaNs have no place on it and are in the tables alone. Nothing where all the others are of one binade
/// of either sign.
std::optional<ExhaustivePlots> exhaustive_plots(const measure::sweep::ExhaustiveRequest& request,
                                                const measure::sweep::ExhaustiveState& state);

/// `lost_bits_max.png` and `wrong.png`, where there are any. Those of an earlier run went with its list of results.
void write_exhaustive_plots(const std::filesystem::path& folder, const measure::sweep::ExhaustiveRequest& request,
                            const measure::sweep::ExhaustiveState& state);

}  // namespace lostbits::output::sweep
