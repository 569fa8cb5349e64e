// Translates SPIR-V to LLVM IR: each function to a function, with the names, types and places of its debug information.
#pragma once

#include <string>

#include "intersect/spirv/shader_lines.hpp"

namespace lostbits::intersect::spirv {

/// Returns the text of a module of LLVM IR from the text of spirv-dis. If `lines` names no file, places are lines of
/// the assembly, in the file `path`. With `has_opaque_pointers`, pointers are written without their targets, as LLVM
/// does since version 15. What has no counterpart becomes a call of a function whose name begins with `refusal`. Throws
/// InputError if the text is not that of a valid module.
std::string llvm_text_of(const std::string& assembly, const std::string& path, const ShaderLines& lines,
                         bool has_opaque_pointers);

/// Name of the source file to which the lines of an assembly refer; empty if the assembly names no file.
std::string source_name(const std::string& assembly);

/// Begin of the name of a function that stands for something that cannot be followed. The rest of the name is the
/// sentence about it.
inline constexpr const char* refusal = "lostbits: ";

}  // namespace lostbits::intersect::spirv
