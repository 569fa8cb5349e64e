// The ends of a colour bar on the command line.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "output/map/map_colour.hpp"

namespace lostbits::analysis::choice {

/// `LO:HI`, in the unit of the metrics that are drawn; nothing where the text is empty. InputError for what is no
/// range, where the metrics have several units or no bar, and for an end that a logarithm cannot have.
std::optional<output::map::BarRange> parse_range(const std::string& text,
                                                 const std::vector<const measure::metric::Metric*>& drawn);

}  // namespace lostbits::analysis::choice
