// The compute program around a function of a shader: it reads rays and solids from buffers and writes what the function
// answers.
#pragma once

#include <string>

#include "intersect/shader/source.hpp"

namespace lostbits::intersect::shader {

/// Rays that one work group answers.
inline constexpr std::size_t group_size = 64;

/// The buffers of the program, by their binding.
enum Binding : unsigned { head, rays, ends, solids, answers, hits, binding_count };

/// What the buffer `head` holds.
struct KernelHead {
    std::uint32_t rays = 0;
    std::uint32_t stride = 0;  ///< numbers from the solid of one ray to that of the next; 0: one for all
    std::uint32_t ends = 0;    ///< whether rays have ends
    std::uint32_t spare = 0;
};

/// The number of the source string that `#line` gives the user's text, and ours behind it, in what compilers say.
inline constexpr int users_string = 1, our_string = 2;

/// GLSL of that version, for numbers of 32 or 64 bits. The user's text stands in it line by line as in the file; what
/// only other stages have (`gl_FragCoord`, `in` and `out` of the file, `main`) is renamed without moving a column.
std::string program_text(const ShaderSource& shader, int bits, int version);

/// A file in float in doubles, or the other way, token by token: types (`vec3`, `dvec3`), and numbers with a point or
/// an exponent (`0.1`, `0.1LF`). Functions that have no form for doubles (`sin`, `pow`) are left for the compiler to
/// refuse.
std::string rewritten(const std::string& text, bool to_doubles);

}  // namespace lostbits::intersect::shader
