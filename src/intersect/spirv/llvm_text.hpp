// SPIR-V as LLVM IR: a function for each function, with the names, types and places of its debug information.
#pragma once

#include <string>

#include "intersect/spirv/shader_lines.hpp"

namespace lostbits::intersect::spirv {

/// Text of a module of LLVM IR from the text of spirv-dis. `path` is the file that places name if `lines` has none:
/// their lines are then those of the assembly. `is_opaque`: pointers are written without their targets, as LLVM does
/// since version 15. What has no counterpart becomes a call of a function whose name begins with `refusal`.
/// InputError if the text is not that of a valid module.
std::string llvm_text_of(const std::string& assembly, const std::string& path, const ShaderLines& lines,
                         bool is_opaque);

/// Name of the file that the lines of an assembly are about; empty if it names none.
std::string source_name(const std::string& assembly);

/// Begins the name of a function that stands for something that cannot be followed. The rest is the sentence.
inline constexpr const char* refusal = "lostbits: ";

}  // namespace lostbits::intersect::spirv
