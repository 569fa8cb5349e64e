// Messages of driver compilers, with positions in the user's file.
#pragma once

#include <string>

#include "intersect/shader/source.hpp"

namespace lostbits::intersect::shader {

/// Converts the log of a compiler to a line `FILE:LINE:COLUMN: text` for each error. Reads the formats of Mesa,
/// glslang, NVIDIA and AMD. An error in our part of the program is reported at the function. Never empty.
std::string errors_of(const std::string& log, const ShaderSource& shader);

}  // namespace lostbits::intersect::shader
