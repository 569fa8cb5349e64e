// The compute program around a function of a shader: it reads rays and primitives from buffers and writes the
// function's answers.
#pragma once

#include <string>
#include <utility>

#include "intersect/shader/source.hpp"

namespace lostbits::intersect::shader {

/// The buffers of the program; the value of an enumerator is the binding.
enum BufferBinding : unsigned { head, rays, ends, primitives, answers, hits, starts, binding_count };

/// Contents of the buffer `head`.
struct KernelHead {
    std::uint32_t ray_count = 0;
    std::uint32_t stride = 0;     ///< numbers from the primitive of one ray to the primitive of the next ray; 0 if all
                                  ///< rays have the same primitive
    std::uint32_t have_ends = 0;  ///< 1 if rays have ends
    std::uint32_t have_starts = 0;  ///< 1 if rays have a beginning other than 0
};

/// Line number at which the code begins that we add to the user's file; the user's file begins at line 1. (`#line` also
/// takes a number for the source string, but Mesa 22 loses this number in expressions.)
inline constexpr int kernel_first_line = 1'000'001;

/// Returns the program, in GLSL of that version for numbers of 32 or 64 bits, or in HLSL if the file is HLSL. The
/// user's text keeps its lines. Names that only other stages have (`gl_FragCoord`, `in` and `out` of the file, `main`)
/// are renamed or blanked without moving a column. Uniforms become variables with the value 0, the value of a uniform
/// that is never set.
std::string write_program_text(const ShaderSource& shader, int bits, int version);

/// Prepares a GLSL file for a program that contains it. Returns two texts: the lines in front of the file (`#version`
/// and declarations), and the text of the file, with the same lines and columns, in which uniforms are variables
/// without a value.
std::pair<std::string, std::string> embeddable_text(const std::string& text);

/// Rewrites a file in float to compute in double, or the other way round, token by token: types (`vec3`, `dvec3`) and
/// numbers with a point or an exponent (`0.1`, `0.1LF`). Functions that do not exist for doubles (`sin`, `pow`) stay,
/// and the compiler rejects them.
std::string convert_precision(const std::string& text, bool to_doubles);

}  // namespace lostbits::intersect::shader
