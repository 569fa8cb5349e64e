// The pictures of an exhaustive sweep: a point a binade.
#pragma once

#include <filesystem>

#include "measure/sweep/exhaustive.hpp"

namespace lostbits::output::sweep {

/// `lost_bits_max.png`: the bits that the worst float of each binade loses; `wrong.png`: the share of floats with a
/// wrong decision. A line a form, ray and sign. Neither where the axis has fewer than two binades of normal numbers;
/// zeros, subnormals, infinities and NaNs have no place on it and are in the tables alone.
void write_exhaustive_plots(const std::filesystem::path& folder, const measure::sweep::ExhaustiveRequest& request,
                            const measure::sweep::ExhaustiveState& state);

}  // namespace lostbits::output::sweep
