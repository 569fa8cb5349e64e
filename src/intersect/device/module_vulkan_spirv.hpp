// GLSL made SPIR-V by glslang's own program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lostbits::intersect::device {

/// Of a compute program. CompileError with what glslang says; EnvironmentError where it is missing.
std::vector<std::uint32_t> spirv_of(const std::string& glsl);

}  // namespace lostbits::intersect::device
