// How much a test that draws tries.
#pragma once

#include <cstdlib>

namespace lostbits::test {

/// Whether all is tried that there is: `./run test --long`.
inline bool is_long() {
    static const bool asked = std::getenv("LOSTBITS_LONG") != nullptr;
    return asked;
}

/// Of so many draws those that are made: all in the long tests, else a tenth.
template <class Count>
Count draws(Count all) {
    return is_long() ? all : all / 10;
}

}  // namespace lostbits::test
