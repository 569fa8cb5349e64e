// Numbers as text that reads back to the same bits.
#pragma once

#include <string>

namespace lostbits::output::file {

/// The shortest decimal that reads back to the same double; `nan` (any NaN), `inf`, `-inf`, and `-0` keeps its sign.
[[nodiscard]] std::string decimal(double value);

/// The shortest decimal that reads back to the same float: `0.1`, not `0.10000000149011612`.
[[nodiscard]] std::string decimal(float value);

/// The exact value as a C hexadecimal float: `0x1.8p+1`, `-0x0p+0`; `nan`, `inf`, `-inf`. A float converts to
/// double exactly, so one function serves both.
[[nodiscard]] std::string hex(double value);

}  // namespace lostbits::output::file
