// Numbers of draws in random tests.
#pragma once

#include <cstdlib>

namespace lostbits::test {

/// True if every case is tried: `./run test --long`.
inline bool is_long() {
    static const bool is_set = std::getenv("LOSTBITS_LONG") != nullptr;
    return is_set;
}

/// Number of draws to make of `all`: all in the long tests, otherwise one in `part`.
template <class Count>
Count draws(Count all, int part = 10) {
    return is_long() ? all : all / static_cast<Count>(part);
}

}  // namespace lostbits::test
