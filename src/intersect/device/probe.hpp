// Measures how a device rounds, by a program that does each operation on numbers whose right answers are computed here.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::device {

struct DeviceFact {
    std::string key;    ///< `f32.dot`
    std::string value;  ///< `x+(y+z)`
};

/// Description of the inputs on which the operations are tried.
extern const std::string_view probed_inputs;

struct Arithmetic {
    std::vector<DeviceFact> facts;
    long long loop_limit = 0;        ///< iterations after which a loop is left silently; 0: no limit found
    bool loops_share_limit = false;  ///< true if the limit is on the sum over all loops of a function, not on each loop
    std::uint64_t digest = 0;        ///< digest of all bits of the answers
};

/// Probes a device. Throws EnvironmentError if the device does not compute at all.
Arithmetic probe(Device& device);

/// One line for the results: `llvmpipe (LLVM 15.0.6), OpenGL 4.5, arithmetic 0123456789abcdef`.
std::string describe_device(const DeviceDescription& description, const Arithmetic& arithmetic);

}  // namespace lostbits::intersect::device
