// The compute program around a function of a shader: it reads rays and solids from buffers and writes what the function
// answers.
#pragma once

#include <string>

#include "intersect/shader/source.hpp"

namespace lostbits::intersect::shader {

/// The buffers of the program, by their binding.
enum BufferPlace : unsigned { head, rays, ends, solids, answers, hits, starts, binding_count };

/// Contents of the buffer `head`.
struct KernelHead {
    std::uint32_t rays = 0;
    std::uint32_t stride = 0;  ///< numbers from the primitive of one ray to that of the next; 0: one for all
    std::uint32_t ends = 0;    ///< 1 if rays have ends
    std::uint32_t starts = 0;  ///< 1 if rays begin elsewhere than at 0
};

/// Our part of the program begins with this line, the user's with line 1. (Mesa 22 forgets the other number of `#line`,
/// that of the source string, in expressions.)
inline constexpr int our_first_line = 1'000'001;

/// GLSL of that version, for numbers of 32 or 64 bits; of a file of HLSL, HLSL. The user's text stands in it line by
/// line as in the file; what only other stages have (`gl_FragCoord`, `in` and `out` of the file, `main`) is renamed
/// without moving a column. Uniforms are variables that hold 0, as they do where nobody sets them.
std::string program_text(const ShaderSource& shader, int bits, int version);

/// A file that computes in float, made to compute in double, or the other way, token by token: types (`vec3`, `dvec3`)
/// and numbers with a point or an exponent (`0.1`, `0.1LF`). Functions that have no form for doubles (`sin`, `pow`) are
/// left for the compiler to refuse.
std::string rewritten(const std::string& text, bool to_doubles);

}  // namespace lostbits::intersect::shader
