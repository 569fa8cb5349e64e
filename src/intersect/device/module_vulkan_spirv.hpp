// Compiles GLSL and HLSL to SPIR-V by the program glslang.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::device {

/// Compiles a compute program to SPIR-V by glslang. Throws CompileError with the messages of glslang, also for HLSL
/// that reads a variable without a value; EnvironmentError if glslang is missing.
std::vector<std::uint32_t> compile_to_spirv(const std::string& text, Language language);

}  // namespace lostbits::intersect::device
