// What an exhaustive sweep found, in words.
#pragma once

#include <string>

#include "measure/sweep/exhaustive.hpp"

namespace lostbits::output::sweep {

/// `0x1.8p+1 (3)`; of a NaN its bits: `nan (0x7fc00000)`.
[[nodiscard]] std::string float_text(std::uint32_t place);
/// The 32 bits: `0x40400000`.
[[nodiscard]] std::string float_bits(std::uint32_t place);

/// `all 8388608 floats between 0x1p+0 (1) and … were tried: sphere.schoolbook decides rightly for every float up to …,
/// and first fails at …: a false miss`. The number is what was counted.
[[nodiscard]] std::string statement(const measure::sweep::ExhaustiveRequest& request,
                                    const measure::sweep::RangeFinding& finding);

/// The command that explains a form on a ray at a float.
[[nodiscard]] std::string explain_float(const measure::sweep::ExhaustiveRequest& request, std::size_t ray,
                                        std::size_t row, std::uint32_t place);

}  // namespace lostbits::output::sweep
