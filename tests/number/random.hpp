// The tests' own generator: the same numbers on every machine and with every library, which the distributions of
// <random> do not guarantee.
#pragma once

#include <cstdint>

namespace lostbits::test {

/// SplitMix64 (Steele, Lea and Flood, 2014).
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
        z = (z ^ z >> 27) * 0x94d049bb133111eb;
        return z ^ z >> 31;
    }
    /// Uniform in [low, high], both included; the bias of the remainder is below 2^-40 for the small ranges asked for.
    long between(long low, long high) {
        return low + static_cast<long>(bits() % (static_cast<std::uint64_t>(high - low) + 1));
    }
    bool one_in(long n) { return between(1, n) == 1; }
    double sign() { return one_in(2) ? 1.0 : -1.0; }
    /// Uniform multiples of 2^-53 in [0, 1).
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

private:
    std::uint64_t state_;
};

}  // namespace lostbits::test
