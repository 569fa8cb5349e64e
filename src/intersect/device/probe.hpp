// How a device rounds: asked by a program that does each operation on numbers whose right answers are computed here.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::device {

struct Fact {
    std::string key;    ///< `f32.dot`
    std::string value;  ///< `x+(y+z)`
};

/// What the operations are tried on, in words.
extern const std::string_view probed_set;

struct Arithmetic {
    std::vector<Fact> facts;
    long long loop_limit = 0;  ///< iterations after which a loop is left silently; 0: none within those that were tried
    bool loops_together = false;  ///< that limit is on all loops of a function together, not on each
    std::uint64_t digest = 0;     ///< of every bit that was answered

    /// The value of a key; empty where it was not probed.
    [[nodiscard]] std::string value_of(std::string_view key) const;
};

/// EnvironmentError where the device does not compute at all.
Arithmetic probe(Device& device);

/// `llvmpipe (LLVM 15.0.6), OpenGL 4.5, arithmetic 0123456789abcdef`: what results carry.
std::string line_of(const DeviceWords& words, const Arithmetic& arithmetic);

}  // namespace lostbits::intersect::device
