// GLSL and HLSL made SPIR-V by glslang's own program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::device {

/// Of a compute program. CompileError with what glslang says, and for HLSL that reads what nobody sets;
/// EnvironmentError where glslang is missing.
std::vector<std::uint32_t> spirv_of(const std::string& text, Language language);

}  // namespace lostbits::intersect::device
