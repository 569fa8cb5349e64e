// Messages of driver compilers, with positions in the user's file.
#pragma once

#include <string>

#include "intersect/shader/source.hpp"

namespace lostbits::intersect::shader {

/// Converts the log of a compiler to a line `FILE:LINE:COLUMN: text` for each error. Reads the formats of Mesa,
/// glslang, NVIDIA and AMD. An error in the code that we add to the file is reported at the user's function. The result
/// is never empty.
std::string errors_of(const std::string& log, const ShaderSource& shader);

}  // namespace lostbits::intersect::shader
