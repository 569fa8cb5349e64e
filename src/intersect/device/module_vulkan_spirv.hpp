// GLSL and HLSL made SPIR-V by glslang's own program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::device {

/// Compiles a compute program to SPIR-V by glslang. CompileError with its messages, also for HLSL that reads a variable
/// without a value; EnvironmentError if glslang is missing.
std::vector<std::uint32_t> spirv_of(const std::string& text, Language language);

}  // namespace lostbits::intersect::device
