// Draws random numbers from a seed, the same on every machine.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace lostbits::scene::rays {

/// Generator of random numbers. The standard fixes the sequence of the engine but not the distributions, so the
/// distributions are our own.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    /// Draws from [0, 1), with 53 bits.
    double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
    double between(double a, double b) { return a + unit() * (b - a); }
    /// Draws from every octave between two positive numbers equally often, with + × and comparisons alone: logarithms
    /// differ between machines.
    double in_octaves(double low, double high) {
        const int octave = below(std::ilogb(high / low) + 1);
        return std::min(high, std::ldexp(low * (1 + unit()), octave));
    }
    /// Draws from 0 … n − 1.
    int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
    double sign() { return below(2) == 0 ? 1 : -1; }

private:
    std::mt19937_64 engine_;
};

}  // namespace lostbits::scene::rays
