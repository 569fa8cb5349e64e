// Translates SPIR-V to LLVM IR: each function to a function, with the names, types and places of its debug information.
#pragma once

#include <string>

#include "intersect/spirv/shader_lines.hpp"

namespace lostbits::intersect::spirv {

/// Returns the text of a module of LLVM IR from the text of spirv-dis. If `lines` names no file, places are lines of
/// the assembly, in the file `path`. With `has_opaque_pointers`, pointers are written without their targets, as LLVM
/// does since version 15. An instruction without a counterpart becomes a call of a function whose name begins
/// with `refusal_prefix`. Throws InputError if the text is not that of a valid module.
std::string translate_to_llvm(const std::string& assembly, const std::string& path, const ShaderLines& lines,
                              bool has_opaque_pointers);

/// Name of the source file to which the lines of an assembly refer; empty if the assembly names no file.
std::string source_file_name(const std::string& assembly);

/// Prefix of the names of functions that stand for instructions that cannot be followed. The rest of such a name is the
/// message about the instruction.
inline constexpr const char* refusal_prefix = "lostbits: ";

}  // namespace lostbits::intersect::spirv
