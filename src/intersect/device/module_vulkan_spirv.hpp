// GLSL and HLSL made SPIR-V by glslang's own program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::device {

/// SPIR-V of a compute program, made by glslang. CompileError with its messages, and for HLSL that reads a variable
/// which nobody sets; EnvironmentError where glslang is missing.
std::vector<std::uint32_t> spirv_of(const std::string& text, Language language);

}  // namespace lostbits::intersect::device
