// Messages of driver compilers, with positions in the user's file.
#pragma once

#include <string>

#include "intersect/shader/source.hpp"

namespace lostbits::intersect::shader {

/// `FILE:LINE:COLUMN: words` for each error of a log about `program_text`, as Mesa, glslang, NVIDIA and AMD write them;
/// what is said of our part of the program names the function. Never empty.
std::string errors_of(const std::string& log, const ShaderSource& shader);

}  // namespace lostbits::intersect::shader
