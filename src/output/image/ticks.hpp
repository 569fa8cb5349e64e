// Round values for the ticks of axes and colour bars.
#pragma once

#include <string>
#include <vector>

namespace lostbits::output::image {

/// 1, 2 or 5 times ten^k: the least such step that is at least `least` > 0.
[[nodiscard]] double round_step(double least);

/// The multiples of `step` from `lo` to `hi`, both included where they are multiples but for rounding.
[[nodiscard]] std::vector<double> multiples(double step, double lo, double hi);

/// With so many significant digits: a tick at 3 times 0.1 is not 0.30000000000000004.
[[nodiscard]] std::string tick_label(double value, int digits = 6);

}  // namespace lostbits::output::image
